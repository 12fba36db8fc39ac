#include "output/result_file.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "base/error.h"
#include "output/array_shape.h"
#include "output/frame_writer.h"
#include "output/pack.h"
#include "output/table.h"

namespace argil::output {

using hdf5::File;
using hdf5::Group;
using hdf5::Shape;

namespace {

template <class Array>
void write_entities(const Group& group, const char* name, const Array& array, const hdf5::Label& label) {
  group.write_array(name, array.data(), entity_shape(array), false, label);
}

void write_field(const Group& group, const char* name, const Field& field, const hdf5::Label& label) {
  group.write_array(name, field.data(), field_shape(field), true, label);
}

// Rows of a series whose tick is at most `last`; ticks increase.
std::uint64_t count_rows_until(const Group& group, Tick last) {
  const std::vector<std::int64_t> ticks = group.open_dataset("tick").read<std::int64_t>();
  return static_cast<std::uint64_t>(std::upper_bound(ticks.begin(), ticks.end(), last) - ticks.begin());
}

const char* spell(Outcome outcome) {
  switch (outcome) {
    case Outcome::running:
      return "running";
    case Outcome::done:
      return "done";
    case Outcome::interrupted:
      return "interrupted";
    case Outcome::failed:
      return "failed";
  }
  return "";
}

void write_outcome(Group& root, Outcome outcome) {
  root.write_attribute("outcome", spell(outcome));
  root.write_attribute("complete", std::int64_t{outcome == Outcome::done});
}

void write_touched_places(const Group& mesh, const std::vector<sim::TouchedPlace>& list) {
  if (list.empty()) return;
  Eigen::Matrix4Xd places(4, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) << list[i].position, list[i].radius;
  write_entities(mesh, "touched_places", places, schema::kTouchedPlaces);
}

void write_mesh(const Group& mesh, const ResultHeader& header) {
  write_entities(mesh, "rest_position", header.rest_position, schema::kRestPosition);
  write_entities(mesh, "tets", header.tets, schema::kTets);
  write_entities(mesh, "surface_triangles", header.surface_triangles, schema::kSurfaceTriangles);
  write_entities(mesh, "skin_triangles", header.skin_triangles, schema::kSkinTriangles);
  write_entities(mesh, "tool_vertices", header.tool.vertices, schema::kToolVertices);
  write_entities(mesh, "tool_triangles", header.tool.triangles, schema::kToolTriangles);
  write_touched_places(mesh, header.touched_places);
}

void write_provenance(const Group& provenance, const ResultHeader& header) {
  for (const auto& [name, text] : header.provenance) {
    ARGIL_ASSERT(!name.empty() && name.find('/') == std::string::npos, name);
    provenance.write_string(name, text, {"-", "what the run was made from"});
  }
}

void write_failure(const Group& root, const Failure& failure) {
  Group group = root.create_group("failure");
  group.write_attribute("about", "why the run stopped: quantity was value at element, past bound");
  group.write_attribute("tick", failure.tick);
  group.write_attribute("stage", failure.stage);
  group.write_attribute("element", std::int64_t{failure.element});
  group.write_attribute("quantity", failure.quantity);
  group.write_attribute("value", failure.value);
  group.write_attribute("bound", failure.bound);
}

std::span<const schema::Column> list_fidelity_columns(bool is_checked) {
  if (is_checked) return schema::kFidelityCheckedStep;
  return schema::kFidelityStep;
}

std::string dotted(std::string name) {
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

const char* unit_of_timing(const std::string& name) {
  if (name.ends_with("_Hz")) return "Hz";
  return name == "instructions" || name.starts_with("num_") ? "1" : "s";
}

hdf5::Label label_timing(const char* unit) {
  return {unit, "measured while the program ran; differs from run to run"};
}

}  // namespace

struct ResultFile::Impl {
  File file;
  Group root;
  FrameWriter frames;
  Group timing;
  Table haptic;
  Table physics;
  int epoch = 0;
  std::optional<Table> fidelity = {};
  std::optional<Table> force_error = {};
  bool is_checked = false;  // fidelity has errors
  std::optional<Table> session = {}, tick_timing = {}, step_timing = {};
  bool is_broken = false;  // a write failed: what follows would have a hole

  // Runs a write; after one that failed nothing more is tried.
  template <class Write>
  void guarded(Write write) {
    ARGIL_ASSERT(!is_broken, "append after a failed write");
    is_broken = true;
    write();
    is_broken = false;
  }
  void remove_checkpoint() {
    if (root.has(schema::kCheckpoint)) root.remove(schema::kCheckpoint);
  }
  void write_all() {
    for (std::optional<Table>* table : {&fidelity, &force_error, &session, &tick_timing, &step_timing})
      if (*table) (*table)->write();
    haptic.write();
    physics.write();
    file.flush();
  }
  // Rows that another table's flush takes along.
  void end_quiet_row(Table& table) {
    if (table.end_row()) guarded([&] { table.write(); });
  }
};

ResultFile::ResultFile(const std::string& name, const ResultHeader& header) {
  File file = File::create(name);
  Group root = file.root();
  root.write_attribute("format", schema::kFormat);
  root.write_attribute("format_version", std::int64_t{schema::kFormatVersion});
  root.write_attribute("haptic_period_s", header.haptic_period);
  write_outcome(root, Outcome::running);
  write_mesh(root.create_group("mesh"), header);
  write_provenance(root.create_group("provenance"), header);
  Table haptic = Table::create(root.create_group("haptic"), schema::kHaptic, schema::kHapticChunk);
  Table physics = Table::create(root.create_group("physics"), schema::kPhysics, schema::kPhysicsChunk);
  Group frames = root.create_group("frames");
  Group timing = root.create_group("timing");
  file.flush();
  m_impl = std::make_unique<Impl>(Impl{std::move(file), std::move(root),
                                       FrameWriter(std::move(frames), 0, header.frame_precision),
                                       std::move(timing), std::move(haptic), std::move(physics)});
  if (header.estimates_error)
    m_impl->force_error =
        Table::create(m_impl->root.open_group("haptic"), schema::kForceError, schema::kHapticChunk);
  if (header.fidelity == sim::FidelityMode::full) return;
  m_impl->is_checked = header.fidelity == sim::FidelityMode::check;
  m_impl->fidelity = Table::create(m_impl->root.create_group(schema::kFidelity),
                                   list_fidelity_columns(m_impl->is_checked), schema::kPhysicsChunk);
  m_impl->file.flush();
}

namespace {

/// Returns the number of those that are left.
int drop_epochs_after(const Group& root, Tick last_tick) {
  if (!root.has(schema::kEpochs)) return 0;
  const Group epochs = root.open_group(schema::kEpochs);
  int left = 0;
  for (const std::string& number : epochs.names())
    if (epochs.open_group(number).read_integer("tick") > last_tick)
      epochs.remove(number);
    else
      ++left;
  return left;
}

}  // namespace

ResultFile::ResultFile(const std::string& name, Tick last_tick, std::uint64_t num_frames,
                       FramePrecision precision) {
  File file = File::open_for_writing(name);
  Group root = file.root();
  if (!root.has_attribute("format") || root.read_text("format") != schema::kFormat ||
      root.read_integer("format_version") != schema::kFormatVersion)
    throw IoError(name, "is not a result file of this version");
  const Group haptic_group = root.open_group("haptic");
  const Group physics_group = root.open_group("physics");
  const std::vector<std::int64_t> ticks = haptic_group.open_dataset("tick").read<std::int64_t>();
  if (last_tick > 0 && (ticks.empty() || ticks.back() < last_tick))
    throw IoError(
        name, "has no records up to tick " + std::to_string(last_tick) + "; it cannot be continued there");
  Table haptic = Table::reopen(haptic_group, schema::kHaptic, schema::kHapticChunk,
                               count_rows_until(haptic_group, last_tick));
  Table physics = Table::reopen(physics_group, schema::kPhysics, schema::kPhysicsChunk,
                                count_rows_until(physics_group, last_tick));
  Group frames = root.open_group("frames");
  const std::vector<std::string> frame_names = frames.names();
  if (frame_names.size() < num_frames)
    throw IoError(
        name, "has lost frames up to tick " + std::to_string(last_tick) + "; it cannot be continued there");
  for (std::size_t i = num_frames; i < frame_names.size(); ++i) frames.remove(frame_names[i]);
  const int epoch = drop_epochs_after(root, last_tick);
  if (root.has("failure")) root.remove("failure");
  write_outcome(root, Outcome::running);
  Group timing = root.open_group("timing");
  file.flush();
  m_impl = std::make_unique<Impl>(Impl{std::move(file), std::move(root),
                                       FrameWriter(std::move(frames), num_frames, precision),
                                       std::move(timing), std::move(haptic), std::move(physics), epoch});
  if (haptic_group.has(schema::kForceError[0].name))
    m_impl->force_error = Table::reopen(haptic_group, schema::kForceError, schema::kHapticChunk,
                                        count_rows_until(haptic_group, last_tick));
  if (!m_impl->root.has(schema::kFidelity)) return;
  const Group group = m_impl->root.open_group(schema::kFidelity);
  m_impl->is_checked = group.has(schema::kFidelityError.name);
  m_impl->fidelity = Table::reopen(group, list_fidelity_columns(m_impl->is_checked), schema::kPhysicsChunk,
                                   count_rows_until(group, last_tick));
}

ResultFile::~ResultFile() {
  if (!m_impl || m_impl->is_broken) return;
  try {
    m_impl->write_all();
  } catch (const IoError&) {  // already on the way out; `complete` = 0 tells
  }
}

void ResultFile::append(const sim::HapticRecord& record) {
  ARGIL_ASSERT(m_impl, "append after finish");
  const Vec4 orientation = record.tool_orientation.coeffs();  // x, y, z, w
  Table& table = m_impl->haptic;
  table.put(record.tick);
  table.put(record.time);
  table.put(record.tool_position.data(), 3);
  table.put(orientation.data(), 4);
  table.put(record.force.data(), 3);
  table.put(record.torque.data(), 3);
  table.put(record.device_force.data(), 3);
  table.put(static_cast<std::uint8_t>(record.mode));
  table.put(record.force_age);
  table.put(record.num_contacts);
  table.put(record.gate_events);
  table.put(record.port_energy);
  table.put(record.passivity_energy);
  if (m_impl->force_error) {
    const sim::ForceErrorParts& parts = record.error;
    m_impl->force_error->put(parts.total());
    const std::array list{parts.mesh, parts.step, parts.contact, parts.solver, parts.left_out};
    m_impl->force_error->put(list.data(), static_cast<unsigned>(list.size()));
    m_impl->end_quiet_row(*m_impl->force_error);
  }
  if (table.end_row()) m_impl->guarded([&] { table.write(), m_impl->file.flush(); });
}

void ResultFile::append(const sim::PhysicsRecord& record) {
  ARGIL_ASSERT(m_impl, "append after finish");
  if (m_impl->fidelity) append_fidelity(record);
  Table& table = m_impl->physics;
  table.put(record.tick);
  table.put(record.time);
  table.put(record.kinetic_energy);
  table.put(record.elastic_energy);
  table.put(record.plastic_dissipation);
  table.put(record.contact_work);
  table.put(record.water_mass);
  table.put(record.water_added);
  table.put(record.water_removed);
  table.put(record.newton_iterations);
  table.put(record.iterations);
  table.put(record.factorisations);
  table.put(record.residual);
  table.put(record.active_nodes);
  table.put(record.min_volume_ratio);
  table.put(record.max_plastic_strain);
  table.put(record.limited_tets);
  table.put(record.limited_tet);
  table.put(record.epoch);
  if (table.end_row()) m_impl->guarded([&] { table.write(), m_impl->file.flush(); });
}

void ResultFile::append_fidelity(const sim::PhysicsRecord& record) {
  Table& table = *m_impl->fidelity;
  table.put(record.tick);
  table.put(static_cast<std::uint8_t>(record.fidelity.rung));
  table.put(record.fidelity.bound);
  table.put(record.fidelity.estimate);
  table.put(record.fidelity.large_strain);
  if (m_impl->is_checked) table.put(record.fidelity.error);
  m_impl->end_quiet_row(table);
}

void ResultFile::append(const sim::Frame& frame) {
  ARGIL_ASSERT(m_impl, "append after finish");
  m_impl->guarded([&] {
    m_impl->frames.write(frame, m_impl->epoch);
    m_impl->file.flush();
  });
}

void ResultFile::begin_epoch(const sim::Body& body) {
  ARGIL_ASSERT(m_impl, "append after finish");
  m_impl->epoch = body.epoch;
  m_impl->guarded([&] {
    Group& root = m_impl->root;
    const Group epochs =
        root.has(schema::kEpochs) ? root.open_group(schema::kEpochs) : root.create_group(schema::kEpochs);
    Group epoch = epochs.create_group(schema::name_number(static_cast<std::uint64_t>(body.epoch)));
    epoch.write_attribute("tick", body.epoch_tick);
    epoch.write_attribute("first_tets", std::int64_t{body.first_tets});
    const Group mesh = epoch.create_group("mesh");
    write_entities(mesh, "rest_position", body.mesh.vertices, schema::kRestPosition);
    write_entities(mesh, "tets", body.mesh.tets, schema::kTets);
    write_entities(mesh, "surface_triangles", body.topology.boundary, schema::kSurfaceTriangles);
    write_entities(mesh, "skin_rest_position", body.skin.vertices, schema::kSkinRestPosition);
    write_entities(mesh, "touched_position", body.touched.vertices, schema::kTouchedPosition);
    write_entities(mesh, "touched_triangles", body.touched.triangles, schema::kTouchedTriangles);
    write_touched_places(mesh, body.touched_places);
    if (body.youngs_modulus.size() > 0)
      write_field(mesh, "youngs_modulus", body.youngs_modulus, schema::kYoungsModulus);
    write_field(mesh, "rest_volume_ratio", body.rest_volume_ratio, schema::kRestVolumeRatio);
    for (std::size_t i = 0; i < body.supports.size(); ++i) {
      const std::vector<int>& held = body.supports[i].region.nodes;
      mesh.write_array(("held_" + std::to_string(i)).c_str(), held.data(), Shape{held.size()}, true,
                       schema::kHeld);
    }
  });
}

void ResultFile::begin_session(const SessionHead& head, bool is_timed) {
  ARGIL_ASSERT(m_impl && !m_impl->session, "one session a file");
  m_impl->guarded([&] {
    Group group = m_impl->root.create_group(schema::kSession);
    group.write_attribute("device", head.device);
    group.write_attribute("max_force_N", head.max_force);
    group.write_attribute("max_torque_Nm", head.max_torque);
    const Vec4 orientation = head.start.orientation.coeffs();
    const auto mode = static_cast<std::uint8_t>(head.start.mode);
    group.write_array("start_position", head.start.position.data(), Shape{3}, false, schema::kStartPosition);
    group.write_array("start_orientation", orientation.data(), Shape{4}, false, schema::kStartOrientation);
    group.write_array("start_mode", &mode, Shape{1}, false, schema::kStartMode);
    m_impl->session = Table::create(group, schema::kSessionTick, schema::kHapticChunk);
    if (!is_timed) return;
    m_impl->tick_timing =
        Table::create(m_impl->timing.create_group("ticks"), schema::kTickTiming, schema::kHapticChunk);
    m_impl->step_timing =
        Table::create(m_impl->timing.create_group("steps"), schema::kStepTiming, schema::kPhysicsChunk);
  });
}

void ResultFile::append(const SessionTick& tick) {
  Table& table = *m_impl->session;
  table.put(tick.sample);
  table.put(tick.seen_step);
  table.put(tick.begun_step);
  table.put(static_cast<std::uint8_t>(tick.device_state));
  table.put(static_cast<std::uint8_t>(tick.feed));
  m_impl->end_quiet_row(table);
}

void ResultFile::append(const TickTiming& timing) {
  Table& table = *m_impl->tick_timing;
  table.put(timing.wake_late);
  table.put(timing.work);
  table.put(timing.sample_age);
  table.put(timing.missed);
  m_impl->end_quiet_row(table);
}

void ResultFile::append(const StepTiming& timing) {
  Table& table = *m_impl->step_timing;
  table.put(timing.wait);
  table.put(timing.work);
  table.put(timing.late);
  m_impl->end_quiet_row(table);
}

void ResultFile::end_session(const std::string& hash) {
  m_impl->guarded([&] { m_impl->root.open_group(schema::kSession).write_attribute("end_hash", hash); });
}

void ResultFile::append_timing(const std::vector<std::pair<std::string, double>>& stages) {
  ARGIL_ASSERT(m_impl, "append after finish");
  m_impl->guarded([&] {
    const Group& timing = m_impl->timing;
    for (const auto& [name, value] : stages) {
      constexpr std::uint64_t kChunk = 16;
      if (!timing.has(name))
        timing.create_series(name, hdf5::Element::real64, {}, kChunk, label_timing(unit_of_timing(name)));
      timing.open_dataset(name).append(&value, 1);
    }
  });
}

void ResultFile::write_checkpoint(const Snapshot& state) {
  ARGIL_ASSERT(m_impl, "checkpoint after finish");
  m_impl->guarded([&] {
    m_impl->remove_checkpoint();
    Group group = m_impl->root.create_group(schema::kCheckpoint);
    for (const auto& [name, array] : state)
      write_entities(group, dotted(name).c_str(), array, schema::kState);
    m_impl->write_all();
    m_impl->file.sync();
  });
}

void ResultFile::finish(const std::optional<Failure>& failure, bool interrupted) {
  ARGIL_ASSERT(m_impl, "finished twice");
  m_impl->guarded([&] {
    if (!failure && !interrupted) m_impl->remove_checkpoint();
    m_impl->write_all();
    if (failure) write_failure(m_impl->root, *failure);
    write_outcome(m_impl->root, failure       ? Outcome::failed
                                : interrupted ? Outcome::interrupted
                                              : Outcome::done);
    m_impl->file.sync();
  });
  // The library closes a file when the last object in it is closed, and reports then what could not be
  // written.
  File file = std::move(m_impl->file);
  const bool is_to_pack = !failure && !interrupted && m_impl->frames.precision() != FramePrecision::whole;
  m_impl.reset();
  file.close();
  if (is_to_pack) try_to_pack(file.name());
}

void write_accuracy(const std::string& result_file, double wanted, double estimated, double cpu_of_passes) {
  File file = File::open_for_writing(result_file);
  {
    Group timing = file.root().open_group("timing");
    if (!timing.has(schema::kCpuOfPasses))
      timing.create_series(schema::kCpuOfPasses, hdf5::Element::real64, {}, 1, label_timing("s"));
    timing.open_dataset(schema::kCpuOfPasses).append(&cpu_of_passes, 1);
    Group group = file.root().create_group(schema::kAccuracy);
    group.write_attribute("wanted", wanted);
    group.write_attribute("estimated", estimated);
  }
  file.flush();
  file.close();
}

}  // namespace argil::output
