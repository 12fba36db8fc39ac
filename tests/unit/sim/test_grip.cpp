// A grip bonds a touched patch to the tool: the same springs both ways, until the mean traction is more than
// it bears. Expected: the forces that pressed, springs of 50 · 2 E* a in all, by the squares of these forces,
// strength · area.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/grip.h"

namespace argil::sim {
namespace {

constexpr double kStrength = 2000.0;          // [Pa]
constexpr contact::Patch kPatch{0.005, 1e5};  // wider than the points lie apart
constexpr int kPoints = 3;
constexpr double kContact = 1e5;  // stiffness of a point [N/m]

/// Three points that a tool above presses down by forces of 0.1, 0.2 and 0.3 N.
struct Scene {
  Points x{3, 3 * kPoints};
  contact::Contacts pressed;
  contact::Pose tool{{0.001, 0.002, 0.01}, Quat(Eigen::AngleAxisd(0.3, Vec3(1, 1, 0).normalized()))};
  Vec3 on_hand = Vec3::Zero();
  Grip grip{kStrength};

  Scene() {
    for (int v = 0; v < x.cols(); ++v) x.col(v) << 1e-3 * (v % 3), 2e-3 * (v / 3), 1e-4 * v;
    for (int i = 0; i < kPoints; ++i) {
      contact::Contact c;
      c.vertex = {3 * i, 3 * i + 1, 3 * i + 2};
      c.weight = {0.5, 0.25, 0.25};
      c.normal = -Vec3::UnitZ();
      c.end_stiffness = c.stiffness = kContact;
      c.end_force = 0.1 * (i + 1);
      c.force = c.end_force * c.normal;
      c.point = 0.5 * x.col(3 * i) + 0.25 * x.col(3 * i + 1) + 0.25 * x.col(3 * i + 2);
      pressed.contacts.push_back(c);
      on_hand -= c.force;
    }
  }
  void hold() { grip.hold(pressed, kPatch, x, on_hand, tool); }
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

/// What presses on a vertex, of the scene above: half of a point's force or a quarter.
double find_pressing(int vertex) {
  return 0.1 * (vertex / 3 + 1) * (vertex % 3 == 0 ? 0.5 : 0.25);
}

TEST(Grip, GoesOnWithVerticesThatLieElsewhere) {
  Scene patch;
  patch.hold();
  const Points before = patch.x;
  for (int v = 0; v < patch.x.cols(); ++v) patch.x.col(v) += Vec3(1e-5 * v, -2e-5, 3e-5);
  Grip grip{kStrength};
  grip.go_on_from(patch.grip, before, patch.x, patch.tool);
  contact::Contacts found;
  grip.find_contacts(patch.x, patch.tool, patch.tool, found);
  ASSERT_EQ(found.contacts.size(), 3 * kPoints);
  for (const contact::Contact& c : found.contacts)
    EXPECT_LT((c.force + find_pressing(c.vertex[0]) * Vec3::UnitZ()).norm(), 1e-12);
}

TEST(Grip, GoesOnWithTheSameVerticesInAnotherOrder) {
  Scene patch;
  patch.hold();
  const Points before = patch.x;
  patch.x = Points(before.rowwise().reverse());
  Grip grip{kStrength};
  grip.go_on_from(patch.grip, before, patch.x, patch.tool);
  contact::Contacts found;
  grip.find_contacts(patch.x, patch.tool, patch.tool, found);
  ASSERT_EQ(found.contacts.size(), 3 * kPoints);
  for (const contact::Contact& c : found.contacts) {
    const int vertex = 3 * kPoints - 1 - c.vertex[0];
    EXPECT_LT((c.force + find_pressing(vertex) * Vec3::UnitZ()).norm(), 1e-12);
  }
}

TEST(Grip, LetsGoOfClayThatIsTornOff) {
  for (const double way : {0.8 * kPatch.radius, 1.2 * kPatch.radius}) {
    Scene patch;
    patch.hold();
    Points left = patch.x;
    left.colwise() += Vec3(0, 0, -way);
    Grip grip{kStrength};
    grip.go_on_from(patch.grip, patch.x, left, patch.tool);
    EXPECT_EQ(grip.holds(), way < kPatch.radius);
    EXPECT_EQ(grip.has_let_go(), way > kPatch.radius);
  }
}

TEST(Grip, TakesHoldWithTheForcesThatPress) {
  Scene patch;
  patch.hold();
  const contact::Contacts found = patch.find(patch.tool);
  ASSERT_EQ(found.contacts.size(), 3 * kPoints);
  for (const contact::Contact& c : found.contacts) {
    EXPECT_LT((c.force + find_pressing(c.vertex[0]) * Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_EQ(c.point, patch.x.col(c.vertex[0]));
  }
  EXPECT_LT((found.force_on_tool - patch.on_hand).norm(), 1e-12);
  Vec3 torque = Vec3::Zero();
  for (const contact::Contact& c : patch.pressed.contacts)
    torque -= (c.point - patch.tool.position).cross(c.force);
  EXPECT_LT((found.torque_on_tool - torque).norm(), 1e-15);
}

/// What the contacts press with may be off what the body has answered, which has friction too.
TEST(Grip, TakesHoldWithWhatTheBodyHasAnswered) {
  Scene patch;
  const Vec3 answer = 0.8 * patch.on_hand + Vec3(0.05, -0.02, 0.0);
  patch.grip.hold(patch.pressed, kPatch, patch.x, answer, patch.tool);
  const contact::Contacts found = patch.find(patch.tool);
  EXPECT_LT((found.force_on_tool - answer).norm(), 1e-12);
  for (const contact::Contact& c : found.contacts)
    EXPECT_LT((c.force + find_pressing(c.vertex[0]) / 0.6 * answer).norm(), 1e-12);
}

TEST(Grip, PullsAsItPushesInAllDirections) {
  for (const double contact : {10.0, 1e6}) {  // stiffness of the contact, which does not matter
    Scene patch;
    for (contact::Contact& c : patch.pressed.contacts) c.end_stiffness = contact;
    patch.hold();
    const double all = 50.0 * 2.0 * kPatch.modulus * kPatch.radius;
    double squares = 0.0;
    for (int v = 0; v < 3 * kPoints; ++v) squares += find_pressing(v) * find_pressing(v);
    for (const Vec3& by : {Vec3(0, 0, 1e-3), Vec3(0, 0, -1e-3), Vec3(2e-4, 0, 0), Vec3(-1e-4, 3e-4, 5e-4)})
      for (const contact::Contact& c : patch.find(shift(patch.tool, by)).contacts) {
        const double pressing = find_pressing(c.vertex[0]);
        const double stiffness = all * pressing * pressing / squares;
        EXPECT_NEAR(c.stiffness, stiffness, 1e-12 * all);
        EXPECT_LT((c.force + pressing * Vec3::UnitZ() - stiffness * by).norm(), 1e-12);
      }
  }
}

/// Of a disc on which Hertz's pressure lies as far from its middle in the mean, 3π/16 of the radius, as the
/// scene's forces on vertices.
double find_radius_of_forces(const Scene& patch) {
  Vec3 centre = Vec3::Zero();
  for (int v = 0; v < 3 * kPoints; ++v) centre += find_pressing(v) / 0.6 * patch.x.col(v);
  double distance = 0.0;
  for (int v = 0; v < 3 * kPoints; ++v) distance += find_pressing(v) / 0.6 * (patch.x.col(v) - centre).norm();
  return 16.0 / (3.0 * std::numbers::pi) * distance;
}

/// Where triangles are larger than the patch, the bonds are as stiff as befits the cells that bear it.
TEST(Grip, IsAsStiffAsTheCellsThatBearIt) {
  Scene patch;
  patch.grip.hold(patch.pressed, {1e-4, kPatch.modulus}, patch.x, patch.on_hand, patch.tool);
  double all = 0.0;
  for (const contact::Contact& c : patch.find(patch.tool).contacts) all += c.stiffness;
  EXPECT_NEAR(all / (50.0 * 2.0 * kPatch.modulus * find_radius_of_forces(patch)), 1.0, 1e-12);
}

TEST(Grip, TurnsWithTheTool) {
  Scene patch;
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
  Scene patch;
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
  const double most = kStrength * std::numbers::pi * kPatch.radius * kPatch.radius;  // [N]
  for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.6, 0, -0.8)}) {
    Scene patch;
    patch.hold();
    patch.grip.test(0.999 * most * direction, patch.tool, patch.tool);
    EXPECT_TRUE(patch.grip.holds()) << direction.transpose();
    EXPECT_FALSE(patch.grip.has_let_go());
    patch.grip.test(1.001 * most * direction, patch.tool, patch.tool);
    EXPECT_FALSE(patch.grip.holds()) << direction.transpose();
    EXPECT_TRUE(patch.grip.has_let_go());
    EXPECT_TRUE(patch.find(patch.tool).contacts.empty());
    patch.grip.release();
    EXPECT_FALSE(patch.grip.has_let_go());
  }
}

/// In a dent a ball touches faces in their middles alone: less is covered than what presses lies apart.
TEST(Grip, BearsAsMuchAsADiscAsWideAsWhatPresses) {
  const double radius = find_radius_of_forces(Scene());
  const double most = kStrength * std::numbers::pi * radius * radius;  // [N]
  for (const double share : {0.999, 1.001}) {
    Scene patch;
    patch.grip.hold(patch.pressed, {1e-4, kPatch.modulus}, patch.x, patch.on_hand, patch.tool);
    patch.grip.test(-share * most * Vec3::UnitZ(), patch.tool, patch.tool);
    EXPECT_EQ(patch.grip.holds(), share < 1.0);
  }
}

/// The force goes on as it has changed over as long a way before: lets go where the next answer would be more
/// than the grip bears, not after it. Back from there it holds.
TEST(Grip, LetsGoBeforeTheForceThatItCannotBear) {
  const double most = kStrength * std::numbers::pi * kPatch.radius * kPatch.radius;  // [N]
  const Vec3 way(0.0, 0.0, 1e-4);
  const double answer = 0.5 * most;                    // of pull, after as much way
  const double change = answer + Scene().on_hand.z();  // [N]
  const double share = (most - answer) / change;       // of the way on which the rest is gone
  for (const double part : {-1.0, 0.99 * share, 1.01 * share}) {
    Scene patch;
    patch.hold();
    const contact::Pose there = shift(patch.tool, way);
    patch.grip.test(-answer * Vec3::UnitZ(), there, shift(there, part * way));
    EXPECT_EQ(patch.grip.holds(), part < share) << part;
    EXPECT_EQ(patch.grip.has_let_go(), part > share) << part;
  }
}

/// On what is farther than the way before, the force grows as that of a half-space under the patch, 2 E* a.
TEST(Grip, ExpectsOnALongerWayWhatClayWouldAnswer) {
  const double most = kStrength * std::numbers::pi * kPatch.radius * kPatch.radius;  // [N]
  const Vec3 way(0.0, 0.0, 1e-4);
  const double stiffness = 2.0 * kPatch.modulus * kPatch.radius;   // [N/m]
  constexpr double kChange = 0.01;                                 // [N] on the way before
  const double rest = most + Scene().on_hand.z() - 2.0 * kChange;  // [N] until it lets go
  const double longest = 1.0 + rest / (stiffness * way.z());       // of the way before
  for (const double length : {0.99 * longest, 1.01 * longest}) {
    Scene patch;
    patch.hold();
    const contact::Pose there = shift(patch.tool, way);
    patch.grip.test(patch.on_hand - kChange * Vec3::UnitZ(), there, shift(there, length * way));
    EXPECT_EQ(patch.grip.holds(), length < longest) << length;
  }
}

TEST(Grip, HoldsWhatPressesLessThanWhenItTookHold) {
  Scene patch;
  patch.hold();
  patch.grip.test(0.99 * patch.on_hand, patch.tool, patch.tool);
  EXPECT_TRUE(patch.grip.holds());
  patch.grip.test(1.01 * patch.on_hand, patch.tool, patch.tool);  // presses harder: the patch grows
  EXPECT_FALSE(patch.grip.holds());
  EXPECT_FALSE(patch.grip.has_let_go());
}

TEST(Grip, HoldsNoPointThatHasLeft) {
  Scene patch;
  patch.pressed.contacts[1].end_force = 0.0;
  patch.hold();
  EXPECT_EQ(patch.find(patch.tool).contacts.size(), 3 * (kPoints - 1));
  patch.pressed.contacts.clear();
  patch.hold();
  EXPECT_FALSE(patch.grip.holds());
}

TEST(Grip, GoesOnFromWhatWasCommittedOrSaved) {
  Scene patch;
  patch.hold();
  patch.grip.commit();
  const contact::Pose pulled = shift(patch.tool, Vec3(0, 0, 1e-3));
  const Vec3 wanted = patch.find(pulled).force_on_tool;
  Snapshot saved;
  Archive saving = Archive::make_saving(saved);
  patch.grip.serialize(saving);
  patch.grip.test(Vec3(0, 0, -1e3), patch.tool, patch.tool);
  ASSERT_TRUE(patch.grip.has_let_go());
  patch.grip.roll_back();
  EXPECT_FALSE(patch.grip.has_let_go());
  EXPECT_EQ(patch.find(pulled).force_on_tool, wanted);

  Scene other;
  Archive restoring = Archive::make_restoring(saved, "saved");
  other.grip.serialize(restoring);
  other.grip.release();
  other.grip.roll_back();  // restoring is a commit
  EXPECT_EQ(other.find(pulled).force_on_tool, wanted);

  // And with the answer by which it expects the next one.
  const double most = kStrength * std::numbers::pi * kPatch.radius * kPatch.radius;  // [N]
  const Vec3 way(0.0, 0.0, 1e-4);
  const contact::Pose there = shift(patch.tool, way);
  for (Grip* grip : {&patch.grip, &other.grip}) {
    grip->test(-0.5 * most * Vec3::UnitZ(), there, shift(there, way));
    EXPECT_TRUE(grip->has_let_go());
  }
}

}  // namespace
}  // namespace argil::sim
