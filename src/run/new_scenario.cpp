#include "run/new_scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "base/read_file.h"
#include "mesh_files/readers.h"
#include "output/text.h"
#include "run/files.h"
#include "run/mesh_size.h"
#include "run/placing.h"
#include "run/run.h"
#include "scenario/patch.h"
#include "solid/rigid_motion.h"

namespace argil::run {
namespace {

namespace fs = std::filesystem;
using scenario::Setting;

constexpr const char* kSchemaName = "argil.schema.json";
constexpr double kWidestPath = 30.0;  // of the body's size

std::string to_json(double value) {
  std::ostringstream text;
  text << std::setprecision(9) << value;
  return text.str();
}

std::string to_json(const Vec3& x) {
  return "[" + to_json(x(0)) + ", " + to_json(x(1)) + ", " + to_json(x(2)) + "]";
}

/// One significant digit.
double rounded_to_digit(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)));
  return std::round(value / unit) * unit;
}

/// Outwards, so that what lies on the edge stays within.
double rounded_up(double value) {
  constexpr double kPerMetre = 1e6;
  return std::ceil(value * kPerMetre) / kPerMetre;
}

std::string millimetres(double length) {
  return output::rounded(1e3 * length) + " mm";
}

std::string millimetres(const mesh::Box& box) {
  const Vec3 size = 1e3 * (box.high - box.low);
  return output::rounded(size(0)) + " × " + output::rounded(size(1)) + " × " + output::rounded(size(2)) +
         " mm";
}

mesh::Box find_box(const device::Trace& trace) {
  mesh::Box box;
  for (const device::DeviceSample& sample : trace.samples) box.include(sample.position);
  return box;
}

class Draft {
 public:
  explicit Draft(const NewOptions& options);
  void read_inputs();
  void place();
  void hold();
  void write();

 private:
  std::string relative(const std::string& file) const;
  std::string print(const std::vector<Setting>& fixed) const;
  scenario::Scenario load() const;
  void set_trace(const std::string& key, const std::string& value);
  bool is_given(const std::string& pointer) const;
  device::Trace read_motion();
  void fit_unit_to_body(device::Trace& trace, double body_size);
  bool is_press(const std::optional<contact::Approach>& deepest) const;
  bool try_touch(const Touch& touch);
  bool find_touch();
  std::vector<Setting> hold_below(double share, solid::Region& region) const;
  void write_schema() const;

  const NewOptions& m_options;
  std::string m_file;
  std::vector<Setting> m_given;  // --set
  std::vector<Setting> m_trace;  // units and place of the motion
  std::vector<Setting> m_fixed;
  bool m_meets_solid = false;  // the skin cannot be touched
  double m_scale = 1.0;        // of the mesh
  double m_radius = 0.0;       // of the tool [m]
  int m_up = 2;                // axis
  std::unique_ptr<Placing> m_placing;
};

Draft::Draft(const NewOptions& options) : m_options(options), m_file(options.output) {
  require_input_file(options.mesh);
  require_input_file(options.trace);
  if (m_file.empty()) m_file = fs::path(options.mesh).stem().string() + ".json";
  for (const std::string& input : {options.mesh, options.trace})
    require_other_file(m_file, input, "a file that the scenario names");
  std::error_code ignored;
  if (!options.overwrites && fs::exists(m_file, ignored))
    throw InputError(m_file, "", "is there already", "give another name by -o, or --force to write over it");
  for (const std::string& text : options.settings) m_given.push_back(scenario::parse_setting(text));
  m_up = options.up == "x" ? 0 : options.up == "y" ? 1 : 2;
}

std::string Draft::relative(const std::string& file) const {
  const fs::path folder = fs::absolute(m_file).parent_path();
  return scenario::quote(fs::absolute(file).lexically_proximate(folder).generic_string());
}

bool Draft::is_given(const std::string& pointer) const {
  return std::any_of(m_given.begin(), m_given.end(),
                     [&](const Setting& s) { return (s.pointer + "/").starts_with(pointer + "/"); });
}

void Draft::set_trace(const std::string& key, const std::string& value) {
  m_trace.push_back({key, value});
}

std::string Draft::print(const std::vector<Setting>& fixed) const {
  const std::string kind = mesh_files::is_surface(m_options.mesh) ? "/body/surface" : "/body/mesh";
  std::vector<Setting> all = {
      {"/$schema", scenario::quote(kSchemaName)},
      {"/about", scenario::quote(fs::path(m_options.mesh).filename().string() + ", touched as in " +
                                 fs::path(m_options.trace).filename().string() + ".")},
      {kind + "/file", relative(m_options.mesh)}};
  if (m_scale != 1.0) all.push_back({kind + "/scale", to_json(m_scale)});
  all.insert(all.end(), fixed.begin(), fixed.end());
  all.insert(all.end(), {{"/material/youngs_modulus_Pa", to_json(m_options.youngs_modulus)},
                         {"/material/poissons_ratio", to_json(m_options.poissons_ratio)},
                         {"/material/plasticity/strength_Pa", to_json(m_options.strength)},
                         {"/tool/shape/kind", scenario::quote("sphere")},
                         {"/tool/shape/radius_m", to_json(m_radius)},
                         {"/trace/file", relative(m_options.trace)}});
  all.insert(all.end(), m_trace.begin(), m_trace.end());
  if (m_meets_solid) all.push_back({"/contact/surface", scenario::quote("cage")});
  return scenario::print_patch(all, m_given, m_file);
}

scenario::Scenario Draft::load() const {
  RunOptions options;
  options.scenario = m_file;
  options.text = print(m_fixed);
  return run::load(options);
}

/// A unit that the motion's rate or size speaks for is taken, and said.
device::Trace Draft::read_motion() {
  for (;;) {
    try {
      return device::read_trace(m_options.trace, load().trace.options);
    } catch (const device::UnlikelyUnit& error) {
      if (error.likely().empty()) throw;
      say(m_options.trace, "taken in " + error.likely() + ": " + error.reason() + "; --set " + error.key() +
                               "= says it otherwise");
      set_trace(error.key(), scenario::quote(error.likely()));
    }
  }
}

/// Beside the body too, a motion may be out of all reason.
void Draft::fit_unit_to_body(device::Trace& trace, double body_size) {
  const double ratio = size_of(find_box(trace)) / body_size;
  if (!trace.is_length_assumed || !(ratio > kWidestPath)) return;
  say(m_options.trace, "taken in mm: in metres the motion would be " + output::rounded(ratio) +
                           " times as wide as the body; --trace-unit says it otherwise");
  set_trace("/trace/length_unit", scenario::quote("mm"));
  trace = read_motion();
}

void Draft::read_inputs() {
  constexpr double kToolShare = 0.125;   // of the body's least width
  constexpr double kLeastShare = 0.02;   // of its greatest
  constexpr double kLargestTool = 0.02;  // [m]
  mesh::Box box = read_box(m_options.mesh);
  m_scale = choose_scale(m_options.mesh, m_options.mesh_unit, box);
  box = {m_scale * box.low, m_scale * box.high};
  if (!device::is_within_reach(box.low) || !device::is_within_reach(box.high))
    throw InputError(
        m_options.mesh, "",
        "lies " + output::rounded(box.low.norm()) + " m from the origin, where no device reaches",
        "move it there in the program that made it, or give its unit by --mesh-unit");
  const Vec3 widths = box.high - box.low;
  const double fitting = std::max(kToolShare * widths.minCoeff(), kLeastShare * widths.maxCoeff());
  m_radius =
      m_options.tool_radius > 0.0 ? m_options.tool_radius : std::min(kLargestTool, rounded_to_digit(fitting));
  if (const std::string hole = find_hole(m_options.mesh); !hole.empty() && !is_given("/contact/surface")) {
    m_meets_solid = true;
    say(m_options.mesh, hole + ": the tool meets the solid that is made of it, by /contact/surface");
  }
  if (!m_options.trace_unit.empty()) set_trace("/trace/length_unit", scenario::quote(m_options.trace_unit));
  device::Trace trace = read_motion();
  fit_unit_to_body(trace, size_of(box));
  say(m_options.mesh, millimetres(box));
  say(m_options.trace, output::rounded(trace.duration()) + " s within " + millimetres(find_box(trace)));
  for (const std::string& note : trace.notes) say(m_options.trace, note);
}

/// Is it a touch of more than what holds the body, from which the motion can begin outside?
bool Draft::is_press(const std::optional<contact::Approach>& deepest) const {
  constexpr double kFoot = 0.25;  // of the height
  const mesh::Box& box = m_placing->box();
  return deepest && (deepest->on_body - box.low)(m_up) >= kFoot * (box.high - box.low)(m_up);
}

/// Moves the motion if that makes a press of it.
bool Draft::try_touch(const Touch& touch) {
  if (!is_press(m_placing->foresee(touch))) return false;
  auto moved = std::make_unique<Placing>(touch, load());
  try {
    moved->find();
  } catch (const InputError&) {
    return false;  // which the body's own cells have
  }
  if (moved->start_distance() <= 0.0 || !is_press(moved->find_deepest())) return false;
  m_placing = std::move(moved);
  return true;
}

/// The middle of what lies farthest that way of the body's boundary.
Vec3 find_top(const Placing& placing, const Vec3& way) {
  constexpr double kLayer = 0.05;  // of the body's size
  const Points& x = placing.body().mesh.vertices;
  const Triangles& boundary = placing.body().topology.boundary;
  double most = -std::numeric_limits<double>::infinity();
  for (const int v : boundary.reshaped())
    if (placing.box().distance(x.col(v)) == 0.0) most = std::max(most, way.dot(x.col(v)));
  const double layer = most - kLayer * size_of(placing.box());
  const auto is_in_layer = [&](int v) {  // no crumb beside the surface
    return way.dot(x.col(v)) >= layer && placing.box().distance(x.col(v)) == 0.0;
  };
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const int v : boundary.reshaped())
    if (is_in_layer(v)) {
      sum += x.col(v);
      ++count;
    }
  const Vec3 middle = sum / count + size_of(placing.box()) * way;
  int top = boundary(0, 0);
  for (const int v : boundary.reshaped())
    if (is_in_layer(v) && (x.col(v) - middle).norm() < (x.col(top) - middle).norm()) top = v;
  return x.col(top);
}

/// Where it is nearest, else from above and from the sides; as deep as place brings it, or less.
bool Draft::find_touch() {
  constexpr std::array<double, 3> kDepths = {0.25, 0.06, 0.015};  // of the tool's radius
  const double radius = m_placing->tool_radius();
  for (const double depth : kDepths) {
    if (try_touch({std::nullopt, std::nullopt, depth * radius})) return true;
    for (const auto& [turn, sign] : {std::pair{0, 1.0}, {1, -1.0}, {1, 1.0}, {2, -1.0}, {2, 1.0}}) {
      Vec3 from = Vec3::Zero();
      from((m_up + turn) % 3) = sign;
      if (try_touch({find_top(*m_placing, from), from, depth * radius})) return true;
    }
  }
  return false;
}

void Draft::place() {
  m_placing = std::make_unique<Placing>(Touch{}, load());
  const contact::Approach nearest = m_placing->nearest();
  const bool misses = nearest.distance > 0.0;
  const bool starts_inside = m_placing->start_distance() <= 0.0;
  if (is_given("/trace/device_to_world/translation_m") || !(misses || starts_inside)) return;
  if (misses && size_of(m_placing->path()) == 0.0)
    return say(m_options.trace, "stands still: it is not moved");
  const std::string reason = misses ? "the tool never comes nearer than " + millimetres(nearest.distance)
                                    : "the tool starts in the body";
  if (!find_touch())
    throw InputError(
        m_options.trace, "",
        reason + ", and wherever it is moved to it begins where it is deepest, or meets the foot",
        "turn it, for instance by --set /trace/device_to_world/rotation_xyzw=[1,0,0,0]");
  set_trace("/trace/device_to_world/translation_m", to_json(m_placing->translation()));
  say(m_options.trace, reason + "; moved by /trace/device_to_world/translation_m " +
                           to_json(m_placing->translation()) + " m, as argil place does: it is now " +
                           m_placing->describe(m_placing->find_deepest()));
}

/// A box round the body's lowest part, as settings.
std::vector<Setting> Draft::hold_below(double share, solid::Region& region) const {
  constexpr double kMargin = 0.01;  // of the size
  const mesh::Box& body = m_placing->box();
  const mesh::Box box = body.grown(kMargin * size_of(body));
  region.kind = solid::Region::Kind::box;
  for (int k = 0; k < 3; ++k) {
    region.lower(k) = -rounded_up(-box.low(k));
    region.upper(k) = rounded_up(k == m_up ? body.low(k) + share * (body.high - body.low)(k) : box.high(k));
  }
  return {{"/body/fixed", "[{\"kind\": \"box\", \"lower_m\": " + to_json(region.lower) +
                              ", \"upper_m\": " + to_json(region.upper) + "}]"}};
}

/// By as little as holds it at rest.
void Draft::hold() {
  if (is_given("/body/fixed")) return;
  constexpr std::array<double, 6> kShares = {0.02, 0.05, 0.1, 0.2, 0.35, 0.5};
  constexpr std::size_t kLeastNodes = 3;
  const sim::Body& body = m_placing->body();
  const solid::Elements elements = solid::make_elements(body.mesh, body.topology, solid::ElementKind::p1);
  std::string motion;
  std::string text;
  for (const double share : kShares) {
    solid::Support support;
    std::vector<Setting> setting = hold_below(share, support.region);
    const auto nodes = solid::find_nodes(body.mesh.vertices, std::span(&support.region, 1));
    if (nodes.size() < kLeastNodes) continue;
    const std::string left = solid::find_rigid_motion(
        elements, body.topology, solid::find_constraints(elements, std::span(&support, 1)));
    if (!m_fixed.empty() && !left.empty()) continue;  // not better
    m_fixed = std::move(setting);
    motion = left;
    text = "held: " + std::to_string(nodes.size()) + " vertices of the lowest " +
           output::rounded(100 * share) + " % along " + m_options.up +
           "; --up or /body/fixed says it otherwise";
    if (motion.empty()) break;
  }
  if (m_fixed.empty())
    throw InputError(m_options.mesh, "", "has no foot along " + m_options.up + " to hold it by",
                     "say which axis is up by --up, or hold it by --set /body/fixed=");
  say(m_options.mesh, text + (motion.empty() ? "" : "; not held: " + motion));
}

void Draft::write_schema() const {
  const std::string file = (fs::path(m_file).parent_path() / kSchemaName).string();
  const std::string schema = scenario::print_schema();
  std::error_code ignored;
  if (fs::exists(file, ignored) && !m_options.overwrites &&
      read_file(file).find("\"title\": \"argil scenario\"") == std::string::npos)
    throw InputError(file, "", "is there already, and no schema of argil's", "move it away, or --force");
  output::write_file(file, schema);
}

void Draft::write() {
  load();  // refuses what a run would
  write_schema();
  output::write_file(m_file, print(m_fixed));
  std::printf("%s: a ball of %s presses clay of E = %s and c_u = %s; an editor explains its keys by %s\n",
              m_file.c_str(), millimetres(m_radius).c_str(),
              output::with_prefix(m_options.youngs_modulus, "Pa").c_str(),
              output::with_prefix(m_options.strength, "Pa").c_str(), kSchemaName);
  std::printf("next: argil run %s\n", m_file.c_str());
}

}  // namespace

int write_new_scenario(const NewOptions& options) {
  Draft draft(options);
  draft.read_inputs();
  draft.place();
  draft.hold();
  draft.write();
  return kDone;
}

}  // namespace argil::run
