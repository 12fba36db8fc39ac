// Springs along a touched surface: what they would carry of a tool's path, and no more than Coulomb's law
// allows of what they carried before. Expected: k · path where they stick, μ N where they slid.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/rng.h"
#include "contact/surface_friction.h"

namespace argil::contact {
namespace {

constexpr double kSpring = 2000.0;  // of a point [N/m]
constexpr double kFriction = 0.4;
constexpr int kVertices = 12;

/// Vertices in the plane z = 0, and points between three of them that a tool above presses downwards.
struct Patch {
  Points x;
  Contacts contacts;
  SurfaceFriction friction{kFriction, kVertices};
  Pose pose;

  explicit Patch(double pressing, int num_points = 4) : x(3, kVertices) {
    Rng rng(5);
    for (int v = 0; v < kVertices; ++v) x.col(v) << rng.uniform(-0.01, 0.01), rng.uniform(-0.01, 0.01), 0.0;
    for (int i = 0; i < num_points; ++i) {
      Contact c;
      c.vertex = {3 * i, 3 * i + 1, 3 * i + 2};
      c.weight = {0.2, 0.3, 0.5};
      c.normal = -Vec3::UnitZ();
      c.spring = c.stiffness = kSpring * (1.0 + i);
      c.begin_force = pressing * (1.0 + i);
      contacts.contacts.push_back(c);
    }
    place();
  }
  void place() {
    for (Contact& c : contacts.contacts) {
      c.point.setZero();
      for (std::size_t k = 0; k < 3; ++k) c.point += c.weight[k] * x.col(c.vertex[k]);
    }
    contacts.resistance_on_tool = contacts.resistance_torque_on_tool = Vec3::Zero();
  }
  /// The surface went to x_t1 before; now the tool goes to `to`.
  void move(const Points& x_t1, const Pose& to) {
    const Points x_t0 = x;
    x = x_t1;
    place();
    friction.stretch(x_t0, x_t1, pose, to, contacts);
    pose = to;
  }
  void move(const Vec3& path) { move(x, Pose{pose.position + path, pose.orientation}); }
};

TEST(SurfaceFriction, StretchesByTheToolsPathWhereItSticks) {
  Patch patch(1e6);
  Vec3 path = Vec3::Zero();
  Rng rng(7);
  for (int call = 0; call < 20; ++call) {
    const Vec3 way(rng.uniform(-1e-4, 1e-4), rng.uniform(-1e-4, 1e-4), rng.uniform(-1e-4, 1e-4));
    patch.move(way);
    path += Vec3(way.x(), way.y(), 0.0);  // along the surface alone
    for (const Contact& c : patch.contacts.contacts)
      ASSERT_LT((c.resistance - c.stiffness * path).norm(), 1e-12 * c.stiffness) << call;
  }
}

TEST(SurfaceFriction, KeepsNoMoreThanCoulombsLimitOfTheStart) {
  constexpr double kPressing = 0.5;
  Patch patch(kPressing);
  const Vec3 way(3e-3, -4e-3, 0.0);  // k · 5 mm is far beyond
  patch.move(way);
  for (int call = 0; call < 3; ++call) {
    patch.move(Vec3::Zero());
    for (const Contact& c : patch.contacts.contacts) {
      const Vec3 wanted = kFriction * c.begin_force * way.normalized();
      ASSERT_LT((c.resistance - wanted).norm(), 1e-12);
    }
  }
  // A path that is added goes on from there.
  const Vec3 small(1e-5, 2e-5, 0.0);
  patch.move(small);
  for (const Contact& c : patch.contacts.contacts) {
    const Vec3 wanted = kFriction * c.begin_force * way.normalized() + c.stiffness * small;
    ASSERT_LT((c.resistance - wanted).norm(), 1e-12);
  }
}

TEST(SurfaceFriction, StretchesByWhatATurningToolMovesAtThePoint) {
  Patch patch(1e6);
  patch.move(Vec3(1e-4, 0.0, 0.0));
  const Quat turn(Eigen::AngleAxisd(0.01, Vec3::UnitZ()));
  const Vec3 centre = patch.pose.position;
  patch.move(patch.x, Pose{centre, turn * patch.pose.orientation});
  for (const Contact& c : patch.contacts.contacts) {
    const Vec3 wanted = Vec3(1e-4, 0.0, 0.0) + turn * (c.point - centre) - (c.point - centre);
    EXPECT_LT((c.resistance / c.stiffness - wanted).norm(), 1e-15);
  }
}

TEST(SurfaceFriction, IsSlackenedByABodyThatGoesAlong) {
  Patch patch(1e6);
  const Vec3 way(1e-4, 2e-4, 0.0);
  patch.move(way);
  Points along = patch.x;
  along.colwise() += 0.75 * way;
  patch.move(along, patch.pose);
  for (const Contact& c : patch.contacts.contacts)
    EXPECT_LT((c.resistance - 0.25 * c.stiffness * way).norm(), 1e-12 * c.stiffness);
}

TEST(SurfaceFriction, GoesOnAfterABodyThatWentAlong) {
  Patch patch(1e6);
  const Vec3 way(1e-4, 2e-4, 0.0);
  patch.move(way);
  const Points before = patch.x;
  patch.x.colwise() += 0.75 * way;
  patch.place();
  SurfaceFriction next(kFriction, kVertices);
  next.go_on_from(patch.friction, before, patch.x, patch.x);
  next.stretch(patch.x, patch.x, patch.pose, patch.pose, patch.contacts);
  for (const Contact& c : patch.contacts.contacts)
    EXPECT_LT((c.resistance - 0.25 * c.stiffness * way).norm(), 1e-12 * c.stiffness);
}

/// Tool and body turn together: nothing is stretched beyond what the turn's chord differs from its arc.
TEST(SurfaceFriction, HoldsNothingUnderACommonRigidTurn) {
  Patch patch(1e6);
  patch.move(Vec3::Zero());
  constexpr int kSteps = 50;
  const Quat turn(Eigen::AngleAxisd(0.5 / kSteps, Vec3::UnitZ()));
  Points before = patch.x;
  for (int i = 0; i < kSteps; ++i) {
    // The tool goes first, then the body after it.
    patch.move(patch.x, Pose{turn * patch.pose.position, turn * patch.pose.orientation});
    Points after = patch.x;
    for (int v = 0; v < kVertices; ++v) after.col(v) = turn * Vec3(patch.x.col(v));
    patch.move(after, patch.pose);
    for (const Contact& c : patch.contacts.contacts)
      ASSERT_LT(c.resistance.norm() / c.stiffness, 1e-15 * kSteps) << i;
  }
  EXPECT_GT((patch.x - before).norm(), 0.005);
}

TEST(SurfaceFriction, ForgetsWhatHasLeft) {
  Patch patch(1e6);
  const std::vector<Contact> all = patch.contacts.contacts;
  patch.move(Vec3(1e-4, 0.0, 0.0));
  patch.contacts.contacts.pop_back();
  patch.move(Vec3(1e-4, 0.0, 0.0));
  patch.contacts.contacts = all;
  patch.move(Vec3(1e-4, 0.0, 0.0));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Contact& c = patch.contacts.contacts[i];
    EXPECT_NEAR(c.resistance.x() / c.stiffness, i + 1 < all.size() ? 3e-4 : 1e-4, 1e-15) << i;
  }
}

TEST(SurfaceFriction, ActsOnTheToolAsOnTheBody) {
  Patch patch(0.3);
  for (const Vec3& way : {Vec3(2e-3, 1e-3, 0.0), Vec3(1e-4, -3e-4, 1e-4)}) patch.move(way);
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  for (const Contact& c : patch.contacts.contacts) {
    EXPECT_EQ(c.friction, kFriction);
    force -= c.resistance;
    torque -= (c.point - patch.pose.position).cross(c.resistance);
  }
  ASSERT_GT(force.norm(), 0.1);
  EXPECT_LT((force - patch.contacts.resistance_on_tool).norm(), 1e-14);
  EXPECT_LT((torque - patch.contacts.resistance_torque_on_tool).norm(), 1e-16);
}

/// Turned scenes have turned answers.
TEST(SurfaceFriction, HasNoAxes) {
  Patch plain(0.3);
  Patch turned(0.3);
  const Quat turn(Eigen::AngleAxisd(1.3, Vec3(1, -2, 0.5).normalized()));
  for (int v = 0; v < kVertices; ++v) turned.x.col(v) = turn * Vec3(plain.x.col(v));
  for (Contact& c : turned.contacts.contacts) c.normal = turn * c.normal;
  for (const Vec3& way : {Vec3(2e-4, 1e-4, 0.0), Vec3(1e-4, -3e-4, 1e-4), Vec3(0.0, 1e-4, 0.0)}) {
    plain.move(way);
    turned.move(turn * way);
    for (std::size_t i = 0; i < plain.contacts.contacts.size(); ++i)
      ASSERT_LT(
          (turned.contacts.contacts[i].resistance - turn * plain.contacts.contacts[i].resistance).norm(),
          1e-12);
  }
}

std::vector<Vec3> list_resistances(const Patch& patch) {
  std::vector<Vec3> list;
  for (const Contact& c : patch.contacts.contacts) list.push_back(c.resistance);
  return list;
}

TEST(SurfaceFriction, GoesOnFromWhatWasCommittedOrSaved) {
  const Vec3 first(2e-4, 1e-4, 0.0), failed(-5e-3, 7e-3, 0.0), next(0.0, 3e-5, 0.0);
  Patch twin(0.3);
  twin.move(first);
  twin.move(next);

  Patch patch(0.3);
  patch.move(first);
  patch.friction.commit();
  const Pose pose = patch.pose;
  patch.move(failed);
  patch.friction.roll_back();
  patch.pose = pose;
  Snapshot saved;
  {
    Archive archive = Archive::make_saving(saved);
    patch.friction.serialize(archive);
  }
  patch.move(next);
  EXPECT_EQ(list_resistances(patch), list_resistances(twin));

  Patch resumed(0.3);
  resumed.pose = pose;
  {
    Archive archive = Archive::make_restoring(saved, "saved");
    resumed.friction.serialize(archive);
  }
  resumed.move(failed);
  resumed.friction.roll_back();  // restoring is a commit
  resumed.pose = pose;
  resumed.move(next);
  EXPECT_EQ(list_resistances(resumed), list_resistances(twin));
}

}  // namespace
}  // namespace argil::contact
