#include "scenario/covered_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "contact/pressure.h"

namespace argil::scenario {
namespace {

constexpr double kStep = 0.02;  // of a tool that covers nothing between two looks, over its thickness
constexpr double kPart = 0.05;  // of one that does, over the largest disc
constexpr double kMostLooks = 2000.0;
constexpr double kFiner = 20.0;    // looks, where none found anything
constexpr double kCovered = 0.75;  // of a disc
constexpr double kApart = 1.4;     // discs of one moment, over the larger radius
constexpr double kSame = 0.25;     // places, over the larger radius

/// The points of a body that keeps its shape have their areas as springs. Around each, the disc [m] as large
/// as what is covered within the distance up to which that is kCovered of all there is.
std::vector<double> find_disc_radii(const std::vector<contact::Contact>& points) {
  std::vector<double> radii;
  std::vector<std::pair<double, double>> others;  // distance [m] less half the point's own extent, area [m²]
  for (const contact::Contact& middle : points) {
    others.clear();
    for (const contact::Contact& other : points) {
      const double area = other.spring;
      const double distance = (other.point - middle.point).norm() - std::sqrt(area / std::numbers::pi);
      others.emplace_back(std::max(0.0, distance), area);
    }
    std::sort(others.begin(), others.end());
    double covered = 0.0;
    for (const auto& [distance, area] : others) {
      if (covered < kCovered * std::numbers::pi * distance * distance) break;
      covered += area;
    }
    radii.push_back(std::sqrt(covered / std::numbers::pi));
  }
  return radii;
}

/// In the stead of one that is as good as there, and smaller.
void add_place(const sim::TouchedPlace& place, std::vector<sim::TouchedPlace>& places) {
  for (sim::TouchedPlace& other : places) {
    const double radius = std::max(other.radius, place.radius);
    if ((place.position - other.position).norm() > kSame * radius) continue;
    if (place.radius > other.radius) other = place;
    return;
  }
  places.push_back(place);
}

/// `ways`: up to each pose [m]. `finer`: so many times more looks.
std::vector<sim::TouchedPlace> look_for_places(std::span<const contact::Pose> poses,
                                               std::span<const double> ways, double finer, double thickness,
                                               contact::PressureContact& contact, const Points& vertices) {
  contact::Contacts found;
  found.with_touched = false;
  std::vector<sim::TouchedPlace> places;
  std::vector<std::size_t> order;
  double next = 0.0;  // way of the next look [m]
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (ways[i] < next) continue;
    contact.find_unpressed(vertices, poses[i], found);
    const std::vector<double> radii = find_disc_radii(found.contacts);
    order.resize(radii.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
    std::vector<std::pair<Vec3, double>> discs;
    for (const std::size_t k : order) {
      const Vec3& middle = found.contacts[k].point;
      const auto holds = [&](const auto& disc) {
        return (middle - disc.first).norm() < kApart * disc.second;
      };
      if (!(radii[k] > 0.0) || std::any_of(discs.begin(), discs.end(), holds)) continue;
      discs.emplace_back(middle, radii[k]);
      add_place({middle, radii[k] / std::numbers::sqrt2}, places);
    }
    const double step = discs.empty() ? kStep / finer * thickness : kPart * discs.front().second;
    next = ways[i] + std::max(step, ways.back() / (finer * kMostLooks));
  }
  return places;
}

}  // namespace

std::vector<sim::TouchedPlace> find_covered_places(std::span<const contact::Pose> poses,
                                                   contact::ToolSolid tool,
                                                   const mesh::TriangleMesh& surface) {
  const double reach = tool.reach();
  const double thickness = tool.thickness();
  const Field one = Field::Ones(surface.num_triangles());
  contact::PressureContact contact(surface.triangles, surface.num_vertices(), std::move(tool), {one, one});
  std::vector<double> ways(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i)
    ways[i] = ways[i - 1] + (poses[i].position - poses[i - 1].position).norm() +
              reach * poses[i].orientation.angularDistance(poses[i - 1].orientation);
  std::vector<sim::TouchedPlace> places =
      look_for_places(poses, ways, 1.0, thickness, contact, surface.vertices);
  if (places.empty()) places = look_for_places(poses, ways, kFiner, thickness, contact, surface.vertices);
  return places;
}

}  // namespace argil::scenario
