#include "run/place.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <memory>
#include <span>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "output/text.h"
#include "run/approach.h"
#include "run/files.h"
#include "scenario/patch.h"

namespace argil::run {
namespace {

using contact::Approach;
using contact::ApproachFinder;
using contact::Pose;

std::string metres(double length) {
  std::ostringstream text;
  text << std::setprecision(4) << length << " m";
  return text.str();
}

std::string say_distance(const Approach& a) {
  return a.distance > 0.0 ? metres(a.distance) + " apart" : metres(-a.distance) + " deep";
}

mesh::Box find_path(const std::vector<Pose>& poses) {
  mesh::Box box;
  for (const Pose& pose : poses) box.include(pose.position);
  return box;
}

std::string say_box(const mesh::Box& box) {
  return print_place(box.low) + " to " + print_place(box.high) + " m";
}

void print_line(const char* name, const std::string& text) {
  std::printf("%-10s%s\n", name, text.c_str());
}

/// A motion in millimetres where metres are meant, or the other way round, shows by its size.
void print_sizes(const mesh::Box& body, const mesh::Box& path) {
  constexpr double kLarge = 30.0;
  constexpr double kSmall = 1e-3;
  const double ratio = (path.high - path.low).norm() / (body.high - body.low).norm();
  if (ratio <= kLarge && ratio >= kSmall) return;
  std::ostringstream text;
  text << std::setprecision(2) << "the path is " << (ratio > 1.0 ? ratio : 1.0 / ratio) << " times "
       << (ratio > 1.0 ? "larger" : "smaller")
       << " than the body: are both in metres? /trace/device_to_world/scale and the mesh's scale say so";
  print_line("note", text.str());
}

/// Where the tool would go, and the poses by which it is asked how deep.
struct Way {
  std::vector<Pose> asked;
  std::size_t first = 0;          ///< number of the first of them
  Vec3 begin = Vec3::Zero();      ///< translation before it starts [m]
  Vec3 direction = Vec3::Zero();  ///< unit
  double most = 0.0;              ///< length [m]
};

/// Begins where the tool is not yet so deep.
void step_back(ApproachFinder& finder, double depth, double step, Way& way) {
  constexpr double kFarthest = 1e3;  // [m]
  double back = 0.0;
  while (finder.find(way.asked, way.begin - back * way.direction).distance < -depth && back < kFarthest)
    back = back > 0.0 ? 2.0 * back : step;
  way.begin -= back * way.direction;
  way.most += back;
}

Way make_way_to_nearest(ApproachFinder& finder, const std::vector<Pose>& poses, const Approach& nearest,
                        double depth) {
  Way way{poses, 0, Vec3::Zero(), nearest.to_body, std::max(0.0, nearest.distance) + 2.0 * depth};
  step_back(finder, depth, 2.0 * finder.tool().thickness(), way);
  return way;
}

Way make_way_to_place(ApproachFinder& finder, const std::vector<Pose>& poses, const Vec3& at,
                      const Vec3& from, double depth) {
  const Vec3 direction = -from.normalized();
  const auto farthest = std::max_element(poses.begin(), poses.end(), [&](const Pose& a, const Pose& b) {
    return direction.dot(a.position) < direction.dot(b.position);
  });
  const double reach = finder.tool().reach();
  Way way{{*farthest},
          static_cast<std::size_t>(farthest - poses.begin()),
          at - farthest->position - reach * direction,
          direction,
          2.0 * (reach + depth)};
  step_back(finder, depth, reach, way);
  return way;
}

/// Translation [m] by which the tool is so deep.
Vec3 find_translation(ApproachFinder& finder, const Way& way, double depth, const PlaceOptions& options) {
  if (const auto shift = finder.find_shift(way.asked, way.begin, way.direction, depth, way.most))
    return way.begin + *shift * way.direction;
  const Approach end = finder.find(way.asked, way.begin + way.most * way.direction);
  const std::string where = say_distance(end) + ", beside " + print_place(end.on_body);
  if (options.at)
    throw InputError("--at", print_place(*options.at),
                     "is no place where the tool meets the body: a little farther on it is " + where,
                     "give a place of the body's surface, and with --from the side that the tool comes from");
  throw InputError("--depth", metres(depth), "is deeper than the tool comes there; it is " + where,
                   "give less");
}

/// The same with the tool moved sideways until it is so deep at the wanted place, as near as that goes: on a
/// slope it meets the body beside the line on which it comes.
Vec3 aim(ApproachFinder& finder, Way way, double depth, const PlaceOptions& options) {
  constexpr int kMostTries = 30;
  constexpr double kClose = 1e-3;  // of the depth
  Vec3 best = find_translation(finder, way, depth, options);
  Vec3 last = best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostTries; ++i) {
    Pose tool = way.asked.front();
    tool.position += last;
    const double missing = depth - finder.find_depth(tool, *options.at);
    if (missing < least) {
      least = missing;
      best = last;
    }
    const Vec3 miss = *options.at - finder.find(way.asked, last).on_body;
    const Vec3 beside = miss - miss.dot(way.direction) * way.direction;
    if (missing <= kClose * depth || beside.norm() <= kClose * depth) break;
    way.begin += beside;
    step_back(finder, depth, finder.tool().reach(), way);
    const auto shift = finder.find_shift(way.asked, way.begin, way.direction, depth, way.most);
    if (!shift) break;
    last = way.begin + *shift * way.direction;
  }
  return best;
}

double choose_depth(const contact::ToolSolid& tool, double given) {
  constexpr double kChosen = 0.25;  // of the tool's radius
  if (given <= tool.thickness()) return given > 0.0 ? given : kChosen * tool.thickness();
  throw InputError(
      "--depth", metres(given),
      "is more than the tool's radius, " + metres(tool.thickness()) + ", at which it is thinnest",
      "give less");
}

/// As a patch writes it.
Vec3 rounded_to_nanometres(const Vec3& x) {
  constexpr double kPerMetre = 1e9;
  return (x * kPerMetre).array().round() / kPerMetre;
}

std::string print_patch(const Vec3& translation) {
  std::ostringstream value;
  value << std::setprecision(12) << '[' << translation.x() << ", " << translation.y() << ", "
        << translation.z() << ']';
  return scenario::print_patch({{"/trace/device_to_world/translation_m", value.str()}});
}

/// What is known of a scene.
struct Placement {
  explicit Placement(const scenario::Scenario& s)
      : scene(scenario::build_scene(s)), finder(make_approach_finder(s, scene)) {}
  scenario::Scene scene;
  ApproachFinder finder;
};

/// The scenario with the motion where it touches the body so deep.
class Placing {
 public:
  Placing(const PlaceOptions& options, scenario::Scenario scenario)
      : m_options(options), m_scenario(std::move(scenario)), m_given(translation()) {
    m_placement = std::make_unique<Placement>(m_scenario);
    m_poses = list_poses(m_scenario, m_placement->scene.trace);
    m_nearest = finder().find(m_poses);
    m_depth = choose_depth(finder().tool(), options.depth);
  }

  void print_start() const {
    const mesh::Box path = find_path(m_poses);
    print_line("body", say_box(m_placement->finder.box()) + ", at rest");
    print_line("path", say_box(path) + ", of the hand's point");
    print_line("tool", "a ball of " + metres(m_placement->finder.tool().radius()) + " radius holds it");
    print_sizes(m_placement->finder.box(), path);
    print_line("nearest", say_at(m_nearest));
  }

  /// The body is built with the motion where it is put, so that it is the one that the tool will meet.
  void find() {
    constexpr int kMostTries = 8;
    constexpr double kClose = 0.005;  // of the depth
    for (int i = 0; i < kMostTries; ++i) {
      m_way = m_options.at ? make_way_to_place(finder(), m_poses, *m_options.at, *m_options.from, m_depth)
                           : make_way_to_nearest(finder(), m_poses, m_nearest, m_depth);
      const Vec3 shift = m_options.at ? aim(finder(), m_way, m_depth, m_options)
                                      : find_translation(finder(), m_way, m_depth, m_options);
      const Vec3 found = rounded_to_nanometres(m_given + shift);
      const bool is_same_body = i > 0 || m_scenario.body.cells.kind == scenario::CellKind::even;
      const bool is_close = (found - translation()).norm() <= kClose * m_depth;
      if (is_same_body && is_close) return;
      translation() = found;
      if (m_scenario.body.cells.kind == scenario::CellKind::even) return;
      m_placement = std::make_unique<Placement>(m_scenario);
    }
  }

  void print_end() {
    const Vec3 shift = translation() - m_given;
    Approach touch = finder().find(m_way.asked, shift);
    touch.pose += m_way.first;
    print_line("moved by", print_place(shift) + " m");
    print_line("touches", say_at(touch));
    const Approach deepest = finder().find(m_poses, shift);
    if (deepest.distance < touch.distance - 0.01 * m_depth) print_line("deepest", say_at(deepest));
    const Approach start = finder().find(std::span(m_poses).first(1), shift);
    if (start.distance <= 0.0)
      throw InputError(
          m_scenario.file, "/trace",
          "then starts in or across the body, " + metres(-start.distance) + " deep, and argil run refuses it",
          "give another --at and --from or a smaller --depth, or a motion that begins outside");
  }

  std::string patch() { return print_patch(translation()); }

 private:
  Vec3& translation() { return m_scenario.trace.options.device_to_world.translation; }
  ApproachFinder& finder() { return m_placement->finder; }
  std::string say_at(const Approach& a) const {
    std::ostringstream text;
    text << say_distance(a) << " at " << static_cast<double>(a.pose) * m_scenario.params.rates.haptic_period
         << " s, beside " << print_place(a.on_body) << " m of the body";
    return text.str();
  }

  const PlaceOptions& m_options;
  scenario::Scenario m_scenario;
  Vec3 m_given;  // translation [m]
  std::unique_ptr<Placement> m_placement;
  std::vector<Pose> m_poses;  // where the scenario has them
  Approach m_nearest;         // there
  double m_depth = 0.0;       // wanted [m]
  Way m_way;
};

}  // namespace

int place(const PlaceOptions& options) {
  scenario::Scenario s = load(options.run);
  if (s.mode == scenario::Mode::equilibrium)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no motion to place", "give a trace");
  if (options.at.has_value() != options.from.has_value() || (options.from && !(options.from->norm() > 0.0)))
    throw InputError("--at", "", "and --from go together: a place and the direction that the tool comes from",
                     "write for instance --at 0,0,0.05 --from 0,0,1");
  if (!options.output.empty()) {
    require_no_input(s, options.output);
    for (const std::string& patch : options.run.patches)
      require_other_file(options.output, patch, "the patch that is read", "-o");
  }
  Placing placing(options, std::move(s));
  placing.print_start();
  placing.find();
  placing.print_end();
  if (options.output.empty()) {
    std::printf("\n%s", placing.patch().c_str());
    return kDone;
  }
  output::write_file(options.output, placing.patch());
  std::printf("%s: argil run %s --patch %s\n", options.output.c_str(), options.run.scenario.c_str(),
              options.output.c_str());
  return kDone;
}

}  // namespace argil::run
