// Pressure of tools with sharp edges, of tools deeper than their tip, and of tools that pass through a plate
// in one interval. Expected: Sneddon; a force that grows with the depth and opposes the motion.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "contact/pressure.h"
#include "contact/tool_shape.h"
#include "unit/contact/pressure_scenes.h"

namespace argil::contact {
namespace {

using test::find_spread;
using test::kBall;
using test::kModulus;
using test::kRadius;
using test::kStiffness;
using test::kTip;
using test::make_flat_slab;
using test::make_slab;
using test::make_turned;
using test::Misses;
using test::press;
using test::shoot;

/// F = 2 E* a d.
TEST(HeldPressure, IsSneddonUnderAFlatPunch) {
  constexpr double kPunch = 0.006;
  const mesh::TriangleMesh punch = make_turned({{kPunch, 0.0}, {kPunch, 0.02}}, 96);
  require_closed_surface(punch, "punch");
  for (const double depth : {0.0002, 0.0005, 0.001}) {
    const Contacts found =
        press(make_flat_slab(40), ToolSolid(punch), Pose{{0.0011, 0.0023, -depth}}, Yielding::no);
    EXPECT_NEAR(found.force_on_tool.z() / (2.0 * kModulus * kPunch * depth), 1.0, 0.1) << depth;
  }
}

/// A ball of 2 km, which lies along a slab of 0.1 m to 10⁻⁶ m: a first touch is small beside what is near.
TEST(Pressure, OfAToolThatLiesAlongTheSurfaceTakesFewPoints) {
  constexpr double kFlat = 2e3;
  const mesh::TriangleMesh slab = make_flat_slab(10);
  const Eigen::Index count = slab.triangles.cols();
  for (const double depth : {1e-9, 1e-11, 1e-13}) {
    PressureContact pressure(slab.triangles, slab.num_vertices(),
                             ToolSolid(RoundTool{kFlat, 0.0, kFlat, false}),
                             {Field::Constant(count, kStiffness), Field::Constant(count, kModulus)}, true);
    Contacts found;
    pressure.find_contacts(slab.vertices, Pose{{0.0011, 0.0023, kFlat + 1e-6}},
                           Pose{{0.0011, 0.0023, kFlat - depth}}, Yielding::yes, found);
    EXPECT_LT(found.contacts.size() + found.near.size(), 300'000U) << depth;
    // κ times a cap of the height d, π R d², where the patch of √(2Rd) is as large as some pieces.
    const double cap = kStiffness * std::numbers::pi * kFlat * depth * depth;
    if (depth > 1e-10) {
      EXPECT_NEAR(found.force_on_tool.z() / cap, 1.0, 0.1);
    }
  }
}

/// A pyramid of three sides with its tip at the origin, the same on both sides of y = 0.
mesh::TriangleMesh make_three_sided_tip() {
  mesh::TriangleMesh tip;
  tip.vertices.resize(3, 4);
  tip.vertices << 0.0, 0.01, -0.005, -0.005, 0.0, 0.0, 0.00866, -0.00866, 0.0, 0.03, 0.03, 0.03;
  tip.triangles.resize(3, 4);
  tip.triangles << 0, 0, 0, 1, 2, 3, 1, 2, 1, 2, 3, 3;
  return tip;
}

/// Two faces of 40 mm that cannot give way under a tip of less than a millimetre: the force along the groove
/// is zero by the mirror, that out of it the one over faces a hundredth as large.
TEST(Pressure, InAGrooveOfLargeRigidFacesPointsNowhereAlongIt) {
  const auto groove = [](double x, double) { return 0.5 * std::abs(x); };
  const mesh::TriangleMesh tip = make_three_sided_tip();
  require_closed_surface(tip, "tip");
  const auto press_into = [&](int n, double depth) {
    const mesh::TriangleMesh body = make_slab(n, 0.04, 0.02, groove);
    const Eigen::Index count = body.triangles.cols();
    PressureContact pressure(body.triangles, body.num_vertices(), ToolSolid(tip),
                             {Field::Constant(count, kStiffness), Field::Constant(count, kModulus),
                              std::vector<char>(static_cast<std::size_t>(count), 1)});
    Contacts found;
    const Pose pose{{0.0, 0.00371, -depth}};
    pressure.find_contacts(body.vertices, pose, pose, Yielding::yes, found);
    EXPECT_LT(found.contacts.size(), 10'000U);
    return found.force_on_tool;
  };
  for (const double depth : {0.0005, 0.001, 0.002, 0.003}) {
    const Vec3 force = press_into(2, depth);
    EXPECT_LT(std::abs(force.y()), 0.025 * force.z()) << depth;
    EXPECT_NEAR(force.z() / press_into(200, depth).z(), 1.0, 0.03) << depth;
  }
}

/// Faces of 10 mm, each split in four up to four times.
TEST(HeldPressure, IsTheSameWhenFacesAreSplit) {
  for (const double depth : {0.0005, 0.001, 0.002}) {
    std::vector<double> forces;
    for (const int n : {10, 20, 40, 80, 160})
      forces.push_back(
          press(make_flat_slab(n), ToolSolid(kBall), Pose{{0.0011, 0.0023, kRadius - depth}}, Yielding::no)
              .force_on_tool.z());
    EXPECT_LT(find_spread(forces), 0.01) << depth;
  }
}

/// A wet tool that is pushed on is never felt less: a ball to nearly its radius, a stylus beyond that of its
/// tip.
TEST(HeldPressure, GrowsWithTheDepth) {
  for (const auto& [tool, last_step] : {std::pair{kTip, 75}, std::pair{kBall, 47}}) {
    const mesh::TriangleMesh plane = make_flat_slab(20);
    double last = 0.0, most_lost = 0.0;
    for (int i = 1; i <= last_step; ++i) {
      const double depth = 0.02 * i * tool.tip_radius;
      const double force =
          press(plane, ToolSolid(tool), Pose{{0.0033, 0.0027, tool.tip_radius - depth}}, Yielding::no)
              .force_on_tool.z();
      most_lost = std::max(most_lost, (last - force) / force);
      last = std::max(last, force);
    }
    EXPECT_LT(most_lost, 0.01) << tool.tip_radius;
  }
}

/// Intervals of 14 ms at 5 m/s, and a small tool at 1 ms.
TEST(Pressure, TurnsBackWhatPassesInOneInterval) {
  const RoundTool small{0.001, 0.0, 0.001, false};
  for (const auto& [tool, way] : {std::pair{small, 0.005}, std::pair{small, 0.07}, std::pair{kTip, 0.07},
                                  std::pair{kBall, 0.02}, std::pair{kBall, 0.07}}) {
    const Misses misses = shoot(tool, 0.001, way, 10);
    EXPECT_EQ(misses.missed, 0) << tool.tip_radius << " " << tool.length << " " << way;
    EXPECT_EQ(misses.drawn, 0) << tool.tip_radius << " " << tool.length << " " << way;
  }
}

}  // namespace
}  // namespace argil::contact
