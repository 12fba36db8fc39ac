// Tools whose middle passes the surface of a body within one interval, and what follows. Expected: a force
// back to the side that they came from, until they are out again.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "base/rng.h"
#include "contact/pressure.h"
#include "contact/tool_shape.h"
#include "unit/contact/pressure_scenes.h"

namespace argil::contact {
namespace {

using test::kBall;
using test::kTip;
using test::make_contact;
using test::make_flat_slab;

constexpr RoundTool kSmall{0.001, 0.0, 0.001, false};
constexpr RoundTool kCapsule{0.004, 0.02, 0.004, false};
constexpr Yielding kBoth[] = {Yielding::yes, Yielding::no};

/// Side from which a tool comes, 1: from above; then its axis points up.
Quat turn_to(double side) {
  return Quat(Eigen::AngleAxisd(side > 0.0 ? 0.0 : std::numbers::pi, Vec3::UnitX()));
}

/// A tool at a slab between z = −thickness and 0; `height` is that of its origin over the surface that it
/// comes from.
struct Jump {
  mesh::TriangleMesh body;
  std::function<ToolSolid()> make_tool;
  double radius, side, thickness;
  PressureContact pressure;
  Pose pose;
  Contacts contacts;

  Jump(const RoundTool& tool, double from_side, double slab_thickness, double height, bool is_drawn = false)
      : body(make_flat_slab(10, 0.1, slab_thickness)),
        make_tool(
            [=] { return is_drawn ? ToolSolid(make_sphere_tool(tool.tip_radius, 2)) : ToolSolid(tool); }),
        radius(tool.tip_radius),
        side(from_side),
        thickness(slab_thickness),
        pressure(make_contact(body, make_tool())),
        pose(at(height)) {}
  Pose at(double height) const {
    return {Vec3(0.0033, 0.0027, side > 0.0 ? height : -thickness - height), turn_to(side)};
  }
  /// Force on the tool toward the side that it came from [N].
  double go(const Pose& next, Yielding yielding) {
    pressure.find_contacts(body.vertices, pose, next, yielding, contacts);
    pressure.commit();
    pose = next;
    EXPECT_TRUE(contacts.force_on_tool.allFinite() && contacts.torque_on_tool.allFinite());
    return side * contacts.force_on_tool.z();
  }
};

/// Of a tool of which nothing is known, at rest.
double find_fresh_force(const Jump& jump, const Pose& pose, Yielding yielding) {
  PressureContact pressure = make_contact(jump.body, jump.make_tool());
  Contacts contacts;
  pressure.find_contacts(jump.body.vertices, pose, pose, yielding, contacts);
  return jump.side * contacts.force_on_tool.z();
}

/// Ten intervals at rest after the jump, then back out in a few; then it is felt as one that never passed.
void expect_turned_back(Jump jump, double depth, Yielding yielding, const std::string& what) {
  const Pose start = jump.pose;
  const double jumped = jump.go(jump.at(-depth), yielding);
  EXPECT_GT(jumped, 0.0) << what;
  double first = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double force = jump.go(jump.pose, yielding);
    EXPECT_GE(force, jumped) << what << " " << i;
    if (i == 0) first = force;
    EXPECT_NEAR(force, first, 1e-9 * first) << what << " " << i;
    EXPECT_LT(jump.contacts.contacts.size(), 4000U) << what;
  }
  constexpr int kSteps = 12;
  const Vec3 way = start.position - jump.pose.position;
  for (int i = 1; i <= kSteps; ++i) {
    const double force = jump.go({jump.pose.position + way / kSteps, start.orientation}, yielding);
    EXPECT_GE(force, 0.0) << what << " " << i;
    EXPECT_LE(force, 1.02 * first) << what << " " << i;
  }
  EXPECT_EQ(jump.go(start, yielding), 0.0) << what;
  const Pose touching = jump.at(0.9 * jump.radius);
  jump.go(touching, yielding);
  const double again = jump.go(touching, yielding);
  EXPECT_GT(again, 0.0) << what;
  EXPECT_NEAR(again, find_fresh_force(jump, touching, yielding), 1e-9 * again) << what;
}

TEST(PressurePassage, IsTurnedBackAsLongAsItOverlaps) {
  for (const Yielding yielding : kBoth)
    for (const double side : {1.0, -1.0}) {
      const std::string of = yielding == Yielding::yes ? " yes " : " no ";
      // Through a plate of 1 mm, the middle behind it; and into a block, the tool wholly in it.
      for (const auto& [thickness, depth] : {std::pair{0.001, 0.003}, std::pair{0.06, 0.02}}) {
        const std::string where = of + std::to_string(side) + " " + std::to_string(thickness);
        expect_turned_back(Jump(kBall, side, thickness, 0.012), depth, yielding, "ball" + where);
        expect_turned_back(Jump(kTip, side, thickness, 0.012), depth, yielding, "tip" + where);
        expect_turned_back(Jump(kCapsule, side, thickness, 0.012), depth, yielding, "capsule" + where);
        expect_turned_back(Jump(kBall, side, thickness, 0.012, true), depth, yielding, "drawn ball" + where);
      }
      expect_turned_back(Jump(kSmall, side, 0.001, 0.003), 0.0012, yielding, "small" + of);
    }
}

/// Beyond the body there is nothing left to turn it back to.
TEST(PressurePassage, OfATeleportThroughTheBodyOpposesItOnce) {
  for (const Yielding yielding : kBoth)
    for (const double side : {1.0, -1.0})
      for (const RoundTool& tool : {kBall, kTip, kCapsule, kSmall})
        for (const double thickness : {0.001, 0.03}) {
          Jump jump(tool, side, thickness, 0.05);
          EXPECT_GT(jump.go(jump.at(-0.1), yielding), 0.0) << tool.tip_radius << " " << thickness;
          for (const Contact& c : jump.contacts.contacts) {
            EXPECT_TRUE(c.passes);
            EXPECT_EQ(c.end_force, 0.0);
          }
          EXPECT_EQ(jump.go(jump.pose, yielding), 0.0) << tool.tip_radius << " " << thickness;
        }
}

/// No side is known that it came from; the surfaces around its middle all look away from it.
TEST(PressurePassage, OfAToolThatStartsInsideIsWithoutForce) {
  for (const Yielding yielding : kBoth)
    for (const double depth : {0.0, 0.003, 0.03}) {
      Jump jump(kBall, 1.0, 0.06, -depth);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(jump.go(jump.pose, yielding), 0.0, 1e-12) << depth;
    }
}

/// From any direction onto a plate's faces, 70 mm in one interval: met, and turned back.
TEST(PressurePassage, OpposesWaysFromAllDirections) {
  Rng rng(17);
  const mesh::TriangleMesh plate = make_flat_slab(10, 0.1, 0.001);
  for (const RoundTool& tool : {kBall, kTip, kSmall, kCapsule})
    for (int i = 0; i < 40; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const Vec3 goal(rng.uniform(-0.045, 0.045), rng.uniform(-0.045, 0.045), 0.0);
      const double tilt = rng.uniform(0.0, 1.2), round = rng.uniform(0.0, 6.28);
      const Vec3 way = 0.07 * Vec3(std::sin(tilt) * std::cos(round), std::sin(tilt) * std::sin(round),
                                   -side * std::cos(tilt));
      const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), -way);
      const double before = rng.uniform(0.1, 0.9);
      PressureContact pressure = make_contact(plate, ToolSolid(tool));
      Contacts contacts;
      pressure.find_contacts(plate.vertices, Pose{goal - before * way, turn},
                             Pose{goal + (1.0 - before) * way, turn}, Yielding::yes, contacts);
      EXPECT_LT(contacts.force_on_tool.dot(way), 0.0) << tool.tip_radius << " " << i;
      EXPECT_GT(side * contacts.force_on_tool.z(), 0.0) << tool.tip_radius << " " << i;
    }
}

TEST(PressurePassage, IsRolledBackAndSavedWithTheTick) {
  Jump jump(kBall, 1.0, 0.001, 0.012);
  const Pose above = jump.pose, below = jump.at(-0.003);
  const auto find = [&](PressureContact& pressure, const Pose& from, const Pose& to) {
    pressure.find_contacts(jump.body.vertices, from, to, Yielding::yes, jump.contacts);
    return jump.contacts.force_on_tool.z();
  };
  const double jumped = find(jump.pressure, above, below);
  EXPECT_GT(find(jump.pressure, below, below), 0.0);
  jump.pressure.roll_back();
  EXPECT_LT(find(jump.pressure, below, below), 0.0);  // as one that presses from below
  EXPECT_EQ(find(jump.pressure, above, below), jumped);
  jump.pressure.commit();
  const double kept = find(jump.pressure, below, below);
  jump.pressure.roll_back();
  EXPECT_EQ(find(jump.pressure, below, below), kept);

  Snapshot snapshot;
  Archive saving = Archive::make_saving(snapshot);
  jump.pressure.serialize(saving);
  PressureContact other = make_contact(jump.body, ToolSolid(kBall));
  Archive restoring = Archive::make_restoring(snapshot, "snapshot");
  other.serialize(restoring);
  EXPECT_EQ(find(other, below, below), kept);
}

}  // namespace
}  // namespace argil::contact
