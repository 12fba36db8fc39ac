// A grip bonds a touched patch to the tool: the same springs both ways, until the mean traction is more than
// it bears. Expected: k · (place on the tool − point), strength · area.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/grip.h"

namespace argil::sim {
namespace {

constexpr double kStrength = 2000.0;  // [Pa]
constexpr double kArea = 1e-5;        // of a point [m²]
constexpr int kPoints = 3;

/// Three points that a tool above presses down by forces of 0.1, 0.2 and 0.3 N.
struct Patch {
  Points x{3, 3 * kPoints};
  contact::Contacts pressed;
  contact::Pose tool{{0.001, 0.002, 0.01}, Quat(Eigen::AngleAxisd(0.3, Vec3(1, 1, 0).normalized()))};
  Vec3 on_hand = Vec3::Zero();
  Grip grip{kStrength};

  Patch() {
    for (int v = 0; v < x.cols(); ++v) x.col(v) << 1e-3 * (v % 3), 2e-3 * (v / 3), 1e-4 * v;
    for (int i = 0; i < kPoints; ++i) {
      contact::Contact c;
      c.vertex = {3 * i, 3 * i + 1, 3 * i + 2};
      c.weight = {0.5, 0.25, 0.25};
      c.normal = -Vec3::UnitZ();
      c.end_stiffness = c.stiffness = 1000.0 * (i + 1);
      c.end_force = 0.1 * (i + 1);
      c.force = c.end_force * c.normal;
      c.area = kArea;
      c.point = 0.5 * x.col(3 * i) + 0.25 * x.col(3 * i + 1) + 0.25 * x.col(3 * i + 2);
      pressed.contacts.push_back(c);
      on_hand -= c.force;
    }
  }
  void hold() { grip.hold(pressed, on_hand, tool); }
  contact::Contacts find(const contact::Pose& from, const contact::Pose& to) const {
    contact::Contacts found;
    grip.find_contacts(x, from, to, found);
    return found;
  }
  contact::Contacts find(const contact::Pose& at) const { return find(at, at); }
};

contact::Pose shift(const contact::Pose& pose, const Vec3& by) {
  return {pose.position + by, pose.orientation};
}

TEST(Grip, TakesHoldWithTheForcesThatPress) {
  Patch patch;
  patch.hold();
  const contact::Contacts found = patch.find(patch.tool);
  ASSERT_EQ(found.contacts.size(), patch.pressed.contacts.size());
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    EXPECT_LT((found.contacts[i].force - patch.pressed.contacts[i].force).norm(), 1e-12);
    EXPECT_LT((found.contacts[i].point - patch.pressed.contacts[i].point).norm(), 1e-15);
  }
  EXPECT_LT((found.force_on_tool - patch.on_hand).norm(), 1e-12);
}

TEST(Grip, PullsAsItPushesInAllDirections) {
  Patch patch;
  patch.hold();
  for (const Vec3& by : {Vec3(0, 0, 1e-3), Vec3(0, 0, -1e-3), Vec3(2e-4, 0, 0), Vec3(-1e-4, 3e-4, 5e-4)}) {
    const contact::Contacts found = patch.find(shift(patch.tool, by));
    for (std::size_t i = 0; i < found.contacts.size(); ++i) {
      const contact::Contact& before = patch.pressed.contacts[i];
      EXPECT_LT((found.contacts[i].force - before.force - before.end_stiffness * by).norm(), 1e-12);
      EXPECT_EQ(found.contacts[i].stiffness, before.end_stiffness);
    }
  }
}

TEST(Grip, TurnsWithTheTool) {
  Patch patch;
  patch.hold();
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, -1, 2).normalized()));
  const Vec3 by(0.01, 0.02, -0.03);
  const contact::Contacts still = patch.find(patch.tool);
  for (int v = 0; v < patch.x.cols(); ++v) patch.x.col(v) = turn * Vec3(patch.x.col(v)) + by;
  const contact::Contacts turned =
      patch.find(contact::Pose{turn * patch.tool.position + by, turn * patch.tool.orientation});
  for (std::size_t i = 0; i < still.contacts.size(); ++i) {
    EXPECT_LT((turned.contacts[i].force - turn * still.contacts[i].force).norm(), 1e-12);
    EXPECT_LT((turned.contacts[i].normal - turn * still.contacts[i].normal).norm(), 1e-12);
  }
  EXPECT_LT((turned.torque_on_tool - turn * still.torque_on_tool).norm(), 1e-14);
}

TEST(Grip, ActsOnTheToolAsOnTheBodyByTheMeanOfTheWay) {
  Patch patch;
  patch.hold();
  const contact::Pose from = shift(patch.tool, Vec3(1e-4, 0, 0));
  const contact::Pose to = shift(patch.tool, Vec3(3e-4, 2e-4, 1e-3));
  const contact::Contacts found = patch.find(from, to);
  const contact::Contacts begin = patch.find(from), end = patch.find(to);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    const contact::Contact& c = found.contacts[i];
    EXPECT_LT((c.force - 0.5 * (begin.contacts[i].force + end.contacts[i].force)).norm(), 1e-12);
    EXPECT_NEAR(c.end_force, end.contacts[i].force.dot(c.normal), 1e-12);
    force += c.force;
    torque += (c.point - to.position).cross(c.force);
  }
  EXPECT_LT((found.force_on_tool + force).norm(), 1e-12);
  EXPECT_LT((found.torque_on_tool + torque).norm(), 1e-14);
}

TEST(Grip, LetsGoBeyondItsStrengthTimesItsArea) {
  const double most = kStrength * kArea * kPoints;  // [N]
  for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.6, 0, -0.8)}) {
    Patch patch;
    patch.hold();
    patch.grip.test(0.999 * most * direction, patch.tool);
    EXPECT_TRUE(patch.grip.holds()) << direction.transpose();
    EXPECT_FALSE(patch.grip.has_let_go());
    patch.grip.test(1.001 * most * direction, patch.tool);
    EXPECT_FALSE(patch.grip.holds()) << direction.transpose();
    EXPECT_TRUE(patch.grip.has_let_go());
    EXPECT_TRUE(patch.find(patch.tool).contacts.empty());
    patch.grip.release();
    EXPECT_FALSE(patch.grip.has_let_go());
  }
}

TEST(Grip, HoldsWhatPressesLessThanWhenItTookHold) {
  Patch patch;
  patch.hold();
  patch.grip.test(0.99 * patch.on_hand, patch.tool);
  EXPECT_TRUE(patch.grip.holds());
  patch.grip.test(1.01 * patch.on_hand, patch.tool);  // presses harder: the patch grows
  EXPECT_FALSE(patch.grip.holds());
  EXPECT_FALSE(patch.grip.has_let_go());
}

TEST(Grip, HoldsNoPointThatHasLeft) {
  Patch patch;
  patch.pressed.contacts[1].end_stiffness = 0.0;
  patch.hold();
  EXPECT_EQ(patch.find(patch.tool).contacts.size(), patch.pressed.contacts.size() - 1);
  patch.pressed.contacts.clear();
  patch.hold();
  EXPECT_FALSE(patch.grip.holds());
}

TEST(Grip, GoesOnFromWhatWasCommittedOrSaved) {
  Patch patch;
  patch.hold();
  patch.grip.commit();
  const contact::Pose pulled = shift(patch.tool, Vec3(0, 0, 1e-3));
  const Vec3 wanted = patch.find(pulled).force_on_tool;
  Snapshot saved;
  Archive saving = Archive::make_saving(saved);
  patch.grip.serialize(saving);
  patch.grip.test(Vec3(0, 0, -1e3), patch.tool);
  ASSERT_TRUE(patch.grip.has_let_go());
  patch.grip.roll_back();
  EXPECT_FALSE(patch.grip.has_let_go());
  EXPECT_EQ(patch.find(pulled).force_on_tool, wanted);

  Patch other;
  Archive restoring = Archive::make_restoring(saved, "saved");
  other.grip.serialize(restoring);
  other.grip.release();
  other.grip.roll_back();  // restoring is a commit
  EXPECT_EQ(other.find(pulled).force_on_tool, wanted);
}

}  // namespace
}  // namespace argil::sim
