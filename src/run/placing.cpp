#include "run/placing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <span>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/print.h"
#include "run/approach.h"
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
Vec3 find_translation(ApproachFinder& finder, const Way& way, double depth, const Touch& touch) {
  if (const auto shift = finder.find_shift(way.asked, way.begin, way.direction, depth, way.most))
    return way.begin + *shift * way.direction;
  const Approach end = finder.find(way.asked, way.begin + way.most * way.direction);
  const std::string where = say_distance(end) + ", beside " + print_place(end.on_body);
  if (touch.at)
    throw InputError("--at", print_place(*touch.at),
                     "is no place where the tool meets the body: a little farther on it is " + where,
                     "give a place of the body's surface, and with --from the side that the tool comes from");
  throw InputError("--depth", metres(depth), "is deeper than the tool comes there; it is " + where,
                   "give less");
}

/// The same with the tool moved sideways until it is so deep at the wanted place, as near as that goes: on a
/// slope it meets the body beside the line on which it comes.
Vec3 aim(ApproachFinder& finder, Way way, double depth, const Touch& touch) {
  constexpr int kMostTries = 30;
  constexpr double kClose = 1e-3;  // of the depth
  Vec3 best = find_translation(finder, way, depth, touch);
  Vec3 last = best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostTries; ++i) {
    Pose tool = way.asked.front();
    tool.position += last;
    const double missing = depth - finder.find_depth(tool, *touch.at);
    if (missing < least) {
      least = missing;
      best = last;
    }
    const Vec3 miss = *touch.at - finder.find(way.asked, last).on_body;
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

}  // namespace

Placing::Placement::Placement(const scenario::Scenario& s)
    : scene(scenario::build_scene(s)), finder(make_approach_finder(s, scene)) {}

Placing::Placing(const Touch& touch, scenario::Scenario scenario)
    : m_touch(touch),
      m_scenario(std::move(scenario)),
      m_given(translation()),
      m_placement(std::make_unique<Placement>(m_scenario)),
      m_poses(list_poses(m_scenario, m_placement->scene.trace)),
      m_nearest(finder().find(m_poses)),
      m_depth(choose_depth(finder().tool(), touch.depth)) {
  if (m_placement->scene.trace.is_in_world)
    throw InputError(m_placement->scene.trace.file, "",
                     "is a result, whose places are the tool's in the world",
                     "place the recording that it was made from");
}

mesh::Box Placing::path() const {
  mesh::Box box;
  for (const Pose& pose : m_poses) box.include(pose.position);
  return box;
}

void Placing::print_start() const {
  print_line("body", say_box(box()) + ", at rest");
  print_line("path", say_box(path()) + ", of the hand's point");
  print_line("tool", "a ball of " + metres(m_placement->finder.tool().radius()) + " radius holds it");
  print_sizes(box(), path());
  print_line("nearest", describe(m_nearest));
}

Vec3 Placing::find_shift(const Touch& touch, double depth, Way& way) {
  way = touch.at ? make_way_to_place(finder(), m_poses, *touch.at, *touch.from, depth)
                 : make_way_to_nearest(finder(), m_poses, m_nearest, depth);
  return touch.at ? aim(finder(), way, depth, touch) : find_translation(finder(), way, depth, touch);
}

std::optional<contact::Approach> Placing::foresee(const Touch& touch) {
  try {
    Way way;
    const Vec3 shift = find_shift(touch, choose_depth(finder().tool(), touch.depth), way);
    if (finder().find(std::span(m_poses).first(1), shift).distance <= 0.0) return std::nullopt;
    return finder().find(m_poses, shift);
  } catch (const InputError&) {
    return std::nullopt;  // no touch from there
  }
}

void Placing::find() {
  constexpr int kMostTries = 8;
  constexpr double kClose = 0.005;  // of the depth
  Vec3& moved = m_scenario.trace.options.device_to_world.translation;
  for (int i = 0; i < kMostTries; ++i) {
    const Vec3 found = rounded_to_nanometres(m_given + find_shift(m_touch, m_depth, m_way));
    const bool is_same_body = i > 0 || m_scenario.body.cells.kind == scenario::CellKind::even;
    const bool is_close = (found - moved).norm() <= kClose * m_depth;
    if (is_same_body && is_close) return;
    moved = found;
    if (m_scenario.body.cells.kind == scenario::CellKind::even) return;
    m_placement = std::make_unique<Placement>(m_scenario);
  }
}

double Placing::start_distance() {
  return finder().find(std::span(m_poses).first(1), translation() - m_given).distance;
}

void Placing::print_end() {
  const Vec3 shift = translation() - m_given;
  Approach touch = finder().find(m_way.asked, shift);
  touch.pose += m_way.first;
  print_line("moved by", print_place(shift) + " m");
  print_line("touches", describe(touch));
  const Approach deepest = finder().find(m_poses, shift);
  if (deepest.distance < touch.distance - 0.01 * m_depth) print_line("deepest", describe(deepest));
  const double start = start_distance();
  if (start <= 0.0)
    throw InputError(
        m_scenario.file, "/trace",
        "then starts in or across the body, " + metres(-start) + " deep, and argil run refuses it",
        "give another --at and --from or a smaller --depth, or a motion that begins outside");
}

std::string Placing::patch() const {
  return print_patch(translation());
}

std::string Placing::describe(const Approach& a) const {
  std::ostringstream text;
  text << say_distance(a) << " at " << static_cast<double>(a.pose) * m_scenario.params.rates.haptic_period
       << " s, beside " << print_place(a.on_body) << " m of the body";
  return text.str();
}

}  // namespace argil::run
