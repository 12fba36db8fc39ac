#include "output/result_reader.h"

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "device/trace.h"
#include "output/schema.h"

namespace argil::output {

using hdf5::Dataset;
using hdf5::Group;

namespace {

// One entity a row on disk, one a column in memory: the same bytes.
template <class Array>
Array read_entities(const Group& group, const char* name) {
  using Scalar = typename Array::Scalar;
  constexpr auto kRows = static_cast<std::uint64_t>(Array::RowsAtCompileTime);
  const Dataset dataset = group.open_dataset(name);
  const hdf5::Shape shape = dataset.shape();
  if (shape.size() != 2 || shape[1] != kRows)
    throw IoError(group.file(),
                  dataset.path() + " does not have " + std::to_string(kRows) + " numbers a row");
  const std::vector<Scalar> values = dataset.read<Scalar>();
  return Eigen::Map<const Array>(values.data(), Array::RowsAtCompileTime,
                                 static_cast<Eigen::Index>(shape[0]));
}

// Elements whose every corner is one of so many vertices.
template <class Array>
Array read_elements(const Group& group, const char* name, Eigen::Index num_vertices) {
  Array elements = read_entities<Array>(group, name);
  for (Eigen::Index i = 0; i < elements.size(); ++i)
    if (elements(i) < 0 || elements(i) >= num_vertices)
      throw IoError(group.file(), group.path() + "/" + name + " names vertex " + std::to_string(elements(i)) +
                                      " in row " + std::to_string(i / elements.rows()) + ", and there are " +
                                      std::to_string(num_vertices) + "; the file is damaged");
  return elements;
}

// A frame's array has one entry for each of /mesh.
void check_count(const Group& frame, const char* name, Eigen::Index count, const Dataset& owner) {
  const hdf5::Shape shape = owner.shape();
  if (shape.empty() || static_cast<std::uint64_t>(count) != shape[0])
    throw IoError(frame.file(), frame.path() + "/" + name + " has not as many rows as " + owner.path() +
                                    "; the file is damaged");
}

Field read_field(const Group& group, const char* name) {
  const std::vector<double> values = group.open_dataset(name).read<double>();
  return Eigen::Map<const Field>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// One column of a table, checked to be as long as its ticks.
template <class T>
class ColumnReader {
 public:
  ColumnReader(const Group& group, const char* name, std::size_t rows, std::size_t width)
      : m_values(group.open_dataset(name).read<T>()), m_width(width) {
    if (m_values.size() != rows * width)
      throw IoError(group.file(), group.path() + "/" + name + " has not as many rows as tick");
  }
  T operator()(std::size_t row) const { return m_values[row]; }
  const T* row(std::size_t row) const { return m_values.data() + row * m_width; }

 private:
  std::vector<T> m_values;
  std::size_t m_width;
};

hdf5::Group open_root(const hdf5::File& file) {
  Group root = file.root();
  if (!root.has_attribute("format") || root.read_text("format") != schema::kFormat)
    throw InputError(file.name(), "", "is HDF5 but not a result file of argil",
                     "give the file that a run wrote");
  const std::int64_t version = root.read_integer("format_version");
  if (version != schema::kFormatVersion)
    throw InputError(file.name(), "format_version", std::to_string(version),
                     "this program reads version " + std::to_string(schema::kFormatVersion));
  return root;
}

hdf5::File open(const std::string& file) {
  return hdf5::File::open_for_reading(file);
}

}  // namespace

ResultReader::ResultReader(const std::string& file) : m_file(open(file)), m_root(open_root(m_file)) {}

Outcome ResultReader::outcome() const {
  const std::string text = m_root.read_text("outcome");
  if (text == "done") return Outcome::done;
  if (text == "interrupted") return Outcome::interrupted;
  if (text == "failed") return Outcome::failed;
  return Outcome::running;
}

std::optional<Failure> ResultReader::read_failure() const {
  if (!m_root.has("failure")) return std::nullopt;
  const Group group = m_root.open_group("failure");
  return Failure{
      group.read_integer("tick"),  group.read_text("stage"), static_cast<int>(group.read_integer("element")),
      group.read_text("quantity"), group.read_real("value"), group.read_real("bound")};
}

namespace {

std::vector<sim::TouchedPlace> read_touched_places(const Group& mesh) {
  std::vector<sim::TouchedPlace> places;
  if (!mesh.has("touched_places")) return places;
  const auto columns = read_entities<Eigen::Matrix4Xd>(mesh, "touched_places");
  for (const auto& place : columns.colwise()) places.push_back({place.head<3>(), place(3)});
  return places;
}

}  // namespace

ResultHeader ResultReader::read_header() const {
  const Group mesh = m_root.open_group("mesh");
  ResultHeader header;
  header.rest_position = read_entities<Points>(mesh, "rest_position");
  const Eigen::Index num_vertices = header.rest_position.cols();
  header.tets = read_elements<Tets>(mesh, "tets", num_vertices);
  header.surface_triangles = read_elements<Triangles>(mesh, "surface_triangles", num_vertices);
  header.skin_triangles = read_entities<Triangles>(mesh, "skin_triangles");
  header.tool.vertices = read_entities<Points>(mesh, "tool_vertices");
  header.tool.triangles = read_elements<Triangles>(mesh, "tool_triangles", header.tool.vertices.cols());
  header.touched_places = read_touched_places(mesh);
  header.haptic_period = m_root.read_real("haptic_period_s");
  const Group provenance = m_root.open_group("provenance");
  for (const std::string& name : provenance.names())
    header.provenance.emplace_back(name, provenance.open_dataset(name).read_string());
  return header;
}

int ResultReader::num_epochs() const {
  return m_root.has(schema::kEpochs) ? static_cast<int>(m_root.open_group(schema::kEpochs).names().size())
                                     : 0;
}

CellMesh ResultReader::read_cells(int epoch) const {
  const Group mesh = schema::open_mesh(m_root, epoch);
  CellMesh cells;
  cells.rest_position = read_entities<Points>(mesh, "rest_position");
  cells.tets = read_elements<Tets>(mesh, "tets", cells.rest_position.cols());
  cells.surface_triangles = read_elements<Triangles>(mesh, "surface_triangles", cells.rest_position.cols());
  return cells;
}

std::optional<sim::Body> ResultReader::find_last_cells(Tick until) const {
  const auto begin_of = [this](int epoch) {
    return m_root.open_group(schema::kEpochs)
        .open_group(schema::name_number(static_cast<std::uint64_t>(epoch)))
        .read_integer("tick");
  };
  int epoch = num_epochs();
  while (epoch > 0 && begin_of(epoch) > until) --epoch;
  if (epoch == 0) return std::nullopt;
  const CellMesh cells = read_cells(epoch);
  const Group mesh = schema::open_mesh(m_root, epoch);
  sim::Body body;
  body.epoch = epoch;
  body.epoch_tick = begin_of(epoch);
  body.first_tets = static_cast<int>(m_root.open_group(schema::kEpochs)
                                         .open_group(schema::name_number(static_cast<std::uint64_t>(epoch)))
                                         .read_integer("first_tets"));
  body.mesh = {cells.rest_position, cells.tets, {}};
  body.topology = mesh::make_topology(body.mesh);
  body.skin = {read_entities<Points>(mesh, "skin_rest_position"),
               read_entities<Triangles>(m_root.open_group("mesh"), "skin_triangles")};
  body.touched.vertices = read_entities<Points>(mesh, "touched_position");
  body.touched.triangles = read_elements<Triangles>(mesh, "touched_triangles", body.touched.vertices.cols());
  body.touched_places = read_touched_places(mesh);
  body.rest_volume_ratio = read_field(mesh, "rest_volume_ratio");
  if (mesh.has("youngs_modulus")) body.youngs_modulus = read_field(mesh, "youngs_modulus");
  for (std::string name = "held_0"; mesh.has(name); name = "held_" + std::to_string(body.supports.size())) {
    solid::Support support;
    support.region.kind = solid::Region::Kind::nodes;
    support.region.nodes = mesh.open_dataset(name).read<std::int32_t>();
    body.supports.push_back(std::move(support));
  }
  return body;
}

std::optional<std::string> ResultReader::find_provenance(const std::string& name) const {
  const Group provenance = m_root.open_group("provenance");
  if (!provenance.has(name)) return std::nullopt;
  return provenance.open_dataset(name).read_string();
}

std::vector<sim::HapticRecord> ResultReader::read_haptic() const {
  const Group group = m_root.open_group("haptic");
  const std::vector<std::int64_t> tick = group.open_dataset("tick").read<std::int64_t>();
  const std::size_t rows = tick.size();
  const ColumnReader<double> time(group, "time", rows, 1);
  const ColumnReader<double> tool_position(group, "tool_position", rows, 3);
  const ColumnReader<double> tool_orientation(group, "tool_orientation", rows, 4);
  const ColumnReader<double> force(group, "force", rows, 3);
  const ColumnReader<double> torque(group, "torque", rows, 3);
  const ColumnReader<double> device_force(group, "device_force", rows, 3);
  const ColumnReader<std::uint8_t> mode(group, "mode", rows, 1);
  const ColumnReader<std::int32_t> force_age(group, "force_age", rows, 1);
  const ColumnReader<std::int32_t> num_contacts(group, "num_contacts", rows, 1);
  const ColumnReader<std::uint8_t> gate_events(group, "gate_events", rows, 1);
  const ColumnReader<double> port_energy(group, "port_energy", rows, 1);
  const ColumnReader<double> passivity_energy(group, "passivity_energy", rows, 1);
  std::vector<sim::HapticRecord> records(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    sim::HapticRecord& record = records[i];
    record.tick = tick[i];
    record.time = time(i);
    record.tool_position = Eigen::Map<const Vec3>(tool_position.row(i));
    record.tool_orientation = Quat(Eigen::Map<const Vec4>(tool_orientation.row(i)));  // x, y, z, w
    record.force = Eigen::Map<const Vec3>(force.row(i));
    record.torque = Eigen::Map<const Vec3>(torque.row(i));
    record.device_force = Eigen::Map<const Vec3>(device_force.row(i));
    if (mode(i) >= device::kNumToolModes)
      throw IoError(file(), "/haptic/mode has an unknown mode in row " + std::to_string(i));
    record.mode = static_cast<device::ToolMode>(mode(i));
    record.force_age = force_age(i);
    record.num_contacts = num_contacts(i);
    record.gate_events = gate_events(i);
    record.port_energy = port_energy(i);
    record.passivity_energy = passivity_energy(i);
  }
  if (!has_force_error()) return records;
  const ColumnReader<double> parts(group, "force_error_parts", rows, 5);
  for (std::size_t i = 0; i < rows; ++i) {
    const double* row = parts.row(i);
    records[i].error = {row[0], row[1], row[2], row[3], row[4]};
  }
  return records;
}

bool ResultReader::has_force_error() const {
  return m_root.open_group("haptic").has(schema::kForceError[0].name);
}

std::vector<sim::PhysicsRecord> ResultReader::read_physics() const {
  const Group group = m_root.open_group("physics");
  const std::vector<std::int64_t> tick = group.open_dataset("tick").read<std::int64_t>();
  std::vector<sim::PhysicsRecord> records(tick.size());
  for (std::size_t i = 0; i < tick.size(); ++i) records[i].tick = tick[i];
  const auto read_reals = [&](const char* name, double sim::PhysicsRecord::*member) {
    const ColumnReader<double> column(group, name, records.size(), 1);
    for (std::size_t i = 0; i < records.size(); ++i) records[i].*member = column(i);
  };
  const auto read_counts = [&](const char* name, int sim::PhysicsRecord::*member) {
    const ColumnReader<std::int32_t> column(group, name, records.size(), 1);
    for (std::size_t i = 0; i < records.size(); ++i) records[i].*member = column(i);
  };
  using Record = sim::PhysicsRecord;
  read_reals("time", &Record::time);
  read_reals("kinetic_energy", &Record::kinetic_energy);
  read_reals("elastic_energy", &Record::elastic_energy);
  read_reals("plastic_dissipation", &Record::plastic_dissipation);
  read_reals("contact_work", &Record::contact_work);
  read_reals("water_mass", &Record::water_mass);
  read_reals("water_added", &Record::water_added);
  read_reals("water_removed", &Record::water_removed);
  read_counts("newton_iterations", &Record::newton_iterations);
  read_counts("iterations", &Record::iterations);
  read_counts("factorisations", &Record::factorisations);
  read_reals("residual", &Record::residual);
  read_counts("active_nodes", &Record::active_nodes);
  read_reals("min_volume_ratio", &Record::min_volume_ratio);
  read_reals("max_plastic_strain", &Record::max_plastic_strain);
  if (!group.has("limited_tets")) return records;  // files from before
  read_counts("limited_tets", &Record::limited_tets);
  read_counts("limited_tet", &Record::limited_tet);
  if (group.has("epoch")) read_counts("epoch", &Record::epoch);
  return records;
}

std::optional<std::vector<sim::FidelityRecord>> ResultReader::find_fidelity() const {
  if (!m_root.has(schema::kFidelity)) return std::nullopt;
  const Group group = m_root.open_group(schema::kFidelity);
  std::vector<sim::FidelityRecord> records(group.open_dataset("tick").read<std::int64_t>().size());
  const auto read_reals = [&](const char* name, double sim::FidelityRecord::*member) {
    const ColumnReader<double> column(group, name, records.size(), 1);
    for (std::size_t i = 0; i < records.size(); ++i) records[i].*member = column(i);
  };
  const ColumnReader<std::uint8_t> rung(group, "rung", records.size(), 1);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (rung(i) > static_cast<std::uint8_t>(sim::Rung::solved))
      throw IoError(group.file(), group.path() + "/rung is " + std::to_string(rung(i)) + " in row " +
                                      std::to_string(i) + ", and rungs end at 2; the file is damaged");
    records[i].rung = static_cast<sim::Rung>(rung(i));
  }
  using Record = sim::FidelityRecord;
  read_reals("bound", &Record::bound);
  read_reals("estimate", &Record::estimate);
  read_reals("large_strain", &Record::large_strain);
  if (group.has(schema::kFidelityError.name)) read_reals(schema::kFidelityError.name, &Record::error);
  return records;
}

std::vector<FrameInfo> ResultReader::read_frame_list() const {
  const Group frames = m_root.open_group("frames");
  std::vector<FrameInfo> list;
  for (const std::string& name : frames.names()) {
    const Group frame = frames.open_group(name);
    list.push_back(
        {name, frame.read_integer("tick"), frame.read_real("time"), frame.read_text("state_hash")});
    if (frame.has_attribute(schema::kEpoch))
      list.back().epoch = static_cast<int>(frame.read_integer(schema::kEpoch));
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const FrameInfo& a, const FrameInfo& b) { return a.tick < b.tick; });
  return list;
}

sim::Frame ResultReader::read_frame(const FrameInfo& info) const {
  const Group group = m_root.open_group("frames").open_group(info.name);
  sim::Frame frame;
  frame.tick = info.tick;
  frame.time = info.time;
  frame.state_hash = info.state_hash;
  frame.position = read_entities<Points>(group, "position");
  frame.saturation = read_field(group, "saturation");
  frame.plastic_strain = read_entities<TensorField>(group, "plastic_strain");
  const Group mesh = schema::open_mesh(m_root, info.epoch);
  check_count(group, "position", frame.position.cols(), mesh.open_dataset("rest_position"));
  check_count(group, "saturation", frame.saturation.size(), mesh.open_dataset("tets"));
  check_count(group, "plastic_strain", frame.plastic_strain.cols(), mesh.open_dataset("tets"));
  frame.skin_position = read_entities<Points>(group, "skin_position");
  frame.skin_saturation = read_field(group, "skin_saturation");
  frame.skin_influence = read_field(group, "skin_influence");
  return frame;
}

std::optional<Snapshot> ResultReader::find_checkpoint() const {
  if (!m_root.has(schema::kCheckpoint)) return std::nullopt;
  const Group group = m_root.open_group(schema::kCheckpoint);
  Snapshot state;
  for (const std::string& dotted : group.names()) {
    const hdf5::Dataset array = group.open_dataset(dotted);
    const hdf5::Shape shape = array.shape();
    if (shape.size() != 2) throw IoError(file(), array.path() + " is not a table");
    const std::vector<double> values = array.read<double>();
    std::string name = dotted;
    std::replace(name.begin(), name.end(), '.', '/');
    state[name] = Eigen::Map<const Eigen::MatrixXd>(values.data(), static_cast<Eigen::Index>(shape[1]),
                                                    static_cast<Eigen::Index>(shape[0]));
  }
  return state;
}

namespace {

/// `row`: of /haptic; none: where the session began.
void check_place(const std::string& file, std::optional<std::size_t> row, const Vec3& place) {
  if (device::is_within_reach(place)) return;
  std::ostringstream problem;
  problem << "place " << place.stableNorm() << " m from the origin, more than " << device::kFarthestPlace
          << " m";
  throw InputError(file,
                   row ? "/haptic/tool_position, row " + std::to_string(*row) : "/session/start_position",
                   problem.str(), "no session was recorded so: the file was changed, restore it");
}

}  // namespace

std::optional<std::array<double, 2>> ResultReader::find_accuracy() const {
  if (!m_root.has(schema::kAccuracy)) return std::nullopt;
  const hdf5::Group group = m_root.open_group(schema::kAccuracy);
  return std::array{group.read_real("wanted"), group.read_real("estimated")};
}

std::optional<Session> ResultReader::find_session() const {
  if (!m_root.has(schema::kSession)) return std::nullopt;
  const Group group = m_root.open_group(schema::kSession);
  Session session;
  session.head.device = group.read_text("device");
  session.head.max_force = group.read_real("max_force_N");
  session.head.max_torque = group.read_real("max_torque_Nm");
  const ColumnReader<double> position(group, "start_position", 1, 3);
  const ColumnReader<double> orientation(group, "start_orientation", 1, 4);
  const ColumnReader<std::uint8_t> mode(group, "start_mode", 1, 1);
  session.head.start.position = Eigen::Map<const Vec3>(position.row(0));
  session.head.start.orientation = Quat(Eigen::Map<const Vec4>(orientation.row(0)));  // x, y, z, w
  session.head.start.mode = static_cast<device::ToolMode>(mode(0));
  check_place(file(), std::nullopt, session.head.start.position);
  for (const sim::HapticRecord& record : read_haptic()) {
    check_place(file(), session.samples.size(), record.tool_position);
    session.samples.push_back({record.tool_position, record.tool_orientation, record.mode});
  }
  const std::size_t rows = session.samples.size();
  const ColumnReader<std::int64_t> sample(group, "sample", rows, 1);
  const ColumnReader<std::int64_t> seen_step(group, "seen_step", rows, 1);
  const ColumnReader<std::int64_t> begun_step(group, "begun_step", rows, 1);
  const ColumnReader<std::uint8_t> device_state(group, "device_state", rows, 1);
  const ColumnReader<std::uint8_t> feed(group, "feed", rows, 1);
  for (std::size_t i = 0; i < rows; ++i)
    session.ticks.push_back({sample(i), seen_step(i), begun_step(i),
                             static_cast<device::DeviceState>(device_state(i)),
                             static_cast<device::HandFeed>(feed(i))});
  session.touched_places = read_touched_places(m_root.open_group("mesh"));
  session.is_interrupted = outcome() == Outcome::interrupted || outcome() == Outcome::running;
  if (group.has_attribute("end_hash")) session.end_hash = group.read_text("end_hash");
  return session;
}

std::vector<std::pair<std::string, double>> ResultReader::read_timing() const {
  const Group timing = m_root.open_group("timing");
  std::vector<std::pair<std::string, double>> last;
  for (const std::string& name : timing.names()) {
    if (timing.is_group(name)) continue;  // a live session's ticks and steps
    const std::vector<double> values = timing.open_dataset(name).read<double>();
    if (!values.empty()) last.emplace_back(name, values.back());
  }
  return last;
}

}  // namespace argil::output
