#pragma once

// Tools that press on slabs, for the tests of the pressure law.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/rng.h"
#include "contact/pressure.h"
#include "unit/contact/scenes.h"

namespace argil::contact::test {

inline constexpr double kRadius = 0.008;
inline constexpr RoundTool kBall{kRadius, 0.0, kRadius, false};
inline constexpr RoundTool kTip{0.001, 0.03, 0.003, true};
inline constexpr double kModulus = 1e5;    // E* [Pa]
inline constexpr double kStiffness = 1e8;  // κ [Pa/m]

inline PressureContact make_contact(const mesh::TriangleMesh& body, ToolSolid tool) {
  const Eigen::Index count = body.triangles.cols();
  return {body.triangles, body.num_vertices(), std::move(tool),
          SurfaceStiffness{Field::Constant(count, kStiffness), Field::Constant(count, kModulus)}};
}

inline Contacts press(const mesh::TriangleMesh& body, ToolSolid tool, const Pose& from, const Pose& to,
                      Yielding yielding) {
  PressureContact pressure = make_contact(body, std::move(tool));
  Contacts contacts;
  pressure.find_contacts(body.vertices, from, to, yielding, contacts);
  return contacts;
}

inline Contacts press(const mesh::TriangleMesh& body, ToolSolid tool, const Pose& pose, Yielding yielding) {
  return press(body, std::move(tool), pose, pose, yielding);
}

/// A closed solid of revolution: profile of (radius, height) from the tip up.
inline mesh::TriangleMesh make_turned(const std::vector<std::pair<double, double>>& profile, int segments) {
  mesh::TriangleMesh solid;
  const int rings = static_cast<int>(profile.size());
  solid.vertices.resize(3, rings * segments + 2);
  const int low = rings * segments, high = low + 1;
  std::vector<Eigen::Vector3i> list;
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / segments;
      const auto& [radius, z] = profile[static_cast<std::size_t>(r)];
      solid.vertices.col(r * segments + s) << radius * std::cos(angle), radius * std::sin(angle), z;
      const int next = (s + 1) % segments;
      if (r + 1 < rings)
        list.insert(list.end(), {{r * segments + s, r * segments + next, (r + 1) * segments + next},
                                 {r * segments + s, (r + 1) * segments + next, (r + 1) * segments + s}});
    }
  for (int s = 0; s < segments; ++s) {
    const int next = (s + 1) % segments;
    list.push_back({low, next, s});
    list.push_back({high, (rings - 1) * segments + s, (rings - 1) * segments + next});
  }
  solid.vertices.col(low) << 0.0, 0.0, 0.0;
  solid.vertices.col(high) << 0.0, 0.0, profile.back().second;
  solid.triangles.resize(3, static_cast<Eigen::Index>(list.size()));
  for (std::size_t t = 0; t < list.size(); ++t) solid.triangles.col(static_cast<Eigen::Index>(t)) = list[t];
  return solid;
}

inline double find_spread(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return (*most - *least) / *most;
}

/// How many of `trials` tools that come at this plate, from both sides, at `way` an interval are not met
/// in any interval, or are drawn through when they are.
struct Misses {
  int missed = 0, drawn = 0;
};

inline Misses shoot(const RoundTool& tool, double thickness, double way, int trials) {
  Rng rng(11);
  const mesh::TriangleMesh plate = make_flat_slab(10, 0.1, thickness);
  Misses misses;
  for (int trial = 0; trial < trials; ++trial) {
    const double side = trial % 2 == 0 ? 1.0 : -1.0;
    const double apart = rng.uniform(1e-5, way);
    const double start = side > 0.0 ? tool.tip_radius + apart : -thickness - tool.tip_radius - apart;
    const Quat turn(Eigen::AngleAxisd(side > 0.0 ? 0.0 : std::numbers::pi, Vec3::UnitX()));
    Pose pose{{rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), start}, turn};
    PressureContact pressure = make_contact(plate, ToolSolid(tool));
    Contacts contacts;
    for (int call = 0; call < 20 && contacts.contacts.empty(); ++call) {
      const Pose next{pose.position - Vec3(0.0, 0.0, side * way), turn};
      pressure.find_contacts(plate.vertices, pose, next, Yielding::yes, contacts);
      pose = next;
    }
    misses.missed += contacts.contacts.empty() ? 1 : 0;
    misses.drawn += !contacts.contacts.empty() && !(side * contacts.force_on_tool.z() > 0.0) ? 1 : 0;
  }
  return misses;
}

}  // namespace argil::contact::test
