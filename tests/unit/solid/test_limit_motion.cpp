// Motions that would turn a tet inside out are cut to halves of halves: checked where det F is known in
// closed form.
#include "solid/limit_motion.h"

#include <gtest/gtest.h>

#include <limits>

#include "solid/committed.h"
#include "support/solid_scene.h"

namespace argil::solid {
namespace {

/// A tet on three vertices of the plane z = 0, its apex at height 1. det F is the apex's height.
mesh::TetMesh make_tet() {
  mesh::TetMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  return mesh;
}

struct Scene {
  explicit Scene(const mesh::TetMesh& mesh, std::vector<Support> supports = {}, double bound = 0.0)
      : body(mesh, mesh::make_topology(mesh), std::move(supports), make_params(bound), 1),
        region(body),
        limiter(body),
        state(make_rest_state(body.model)) {
    set_start(body, region, state);
  }
  static SolidParams make_params(double bound) {
    SolidParams params;
    params.min_volume_ratio = bound;
    return params;
  }
  MotionLimit limit() { return limiter.apply(region.part(), state); }
  Body body;
  ActiveRegion region;
  MotionLimiter limiter;
  SolidState state;
};

TEST(MotionLimiter, LeavesToTheBitAMotionThatTurnsNothingInsideOut) {
  Scene scene(make_tet());
  scene.state.x.array() += 1e3;
  scene.state.x(2, 3) -= 0.49;
  scene.state.v.setConstant(7.0);
  const SolidState before = scene.state;
  const MotionLimit limit = scene.limit();
  EXPECT_EQ(limit.num_tets, 0);
  EXPECT_EQ(limit.worst_tet, -1);
  EXPECT_EQ(scene.state.x, before.x);
  EXPECT_EQ(scene.state.v, before.v);
}

TEST(MotionLimiter, HalvesTheWayUntilTheTetIsThickEnough) {
  // The way down is the deformation of the step: d s ≤ ½ with s = ½, ¼, …
  for (const auto& [way, share] : {std::pair(0.51, 0.5), std::pair(0.99, 0.5), std::pair(1.01, 0.25),
                                   std::pair(1.9, 0.25), std::pair(100.0, 1.0 / 256.0)}) {
    Scene scene(make_tet());
    scene.state.x(2, 3) -= way;
    scene.state.v(2, 3) = -8.0;
    const MotionLimit limit = scene.limit();
    EXPECT_EQ(limit.num_tets, 1);
    EXPECT_EQ(limit.worst_tet, 0);
    EXPECT_DOUBLE_EQ(scene.state.x(2, 3), 1.0 - share * way) << way;
    EXPECT_DOUBLE_EQ(scene.state.v(2, 3), -8.0 * share) << way;
    // From there the same way is cut anew: what is held back once is not so for ever.
    EXPECT_EQ(scene.limit().num_tets, 0);
  }
}

TEST(MotionLimiter, KeepsToTheBoundOfTheParameters) {
  Scene scene(make_tet(), {}, 0.6);
  scene.state.x(2, 3) -= 0.6;  // a half of it leaves 0.7, all of it 0.4
  scene.limit();
  EXPECT_DOUBLE_EQ(scene.state.x(2, 3), 0.7);
}

TEST(MotionLimiter, LetsAFlatTetGrowNoFlatterThanATwentieth) {
  Scene scene(make_tet());
  for (const double height : {0.6, 0.4, 0.3, 0.2, 0.14, 0.1, 0.08}) {
    scene.state.x(2, 3) = height;  // each by less than a half
    scene.limit();
    EXPECT_EQ(scene.state.x(2, 3), height);
    set_start(scene.body, scene.region, scene.state);
  }
  scene.state.x(2, 3) = 0.045;
  scene.limit();
  EXPECT_DOUBLE_EQ(scene.state.x(2, 3), 0.0625);
}

TEST(MotionLimiter, KeepsNodesWhereTheyWereWhoseMotionIsNoNumberOrTooLong) {
  for (const double to : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          -std::numeric_limits<double>::infinity(), -1e9}) {
    Scene scene(make_tet());
    scene.state.x(2, 3) = to;
    scene.state.v(2, 3) = to;
    EXPECT_EQ(scene.limit().num_tets, 1);
    EXPECT_EQ(scene.state.x, scene.body.committed.x);
    EXPECT_EQ(scene.state.v, Points::Zero(3, 4));
  }
}

TEST(MotionLimiter, HoldsNoPrescribedComponentBack) {
  // The top of a column of two blocks is driven into it: its nodes go where they must, those below as far as
  // the clay above them allows.
  Support top;
  top.region.kind = Region::Kind::half_space;
  top.region.normal = Vec3(0, 0, -1);
  top.region.offset = -2.0 + 1e-9;
  Scene scene(test::make_block(1, 1, 2, Vec3(1, 1, 2)), {top});
  Points& x = scene.state.x;
  for (Eigen::Index n = 0; n < x.cols(); ++n) {
    if (x(2, n) == 2.0) x(2, n) = 1.8;
    if (x(2, n) == 1.0) x(2, n) = 1.6;
  }
  EXPECT_GT(scene.limit().num_tets, 0);
  for (Eigen::Index n = 0; n < x.cols(); ++n) {
    if (scene.body.committed.x(2, n) == 2.0) {
      EXPECT_EQ(x(2, n), 1.8);
    }
    if (scene.body.committed.x(2, n) == 1.0) {
      EXPECT_DOUBLE_EQ(x(2, n), 1.3);
    }
  }
}

TEST(MotionLimiter, LetsClayElsewhereMoveOn) {
  // A bar of ten blocks whose right end is folded into itself; its left end goes as far as it was to.
  Scene scene(test::make_block(10, 1, 1, Vec3(10, 1, 1)));
  Points& x = scene.state.x;
  for (Eigen::Index n = 0; n < x.cols(); ++n) x(0, n) += x(0, n) == 10.0 ? -1.5 : 0.25;
  const MotionLimit limit = scene.limit();
  EXPECT_GT(limit.num_tets, 0);
  EXPECT_LT(limit.num_tets, 13);
  for (Eigen::Index n = 0; n < x.cols(); ++n) {
    if (scene.body.committed.x(0, n) < 7.0) {
      EXPECT_EQ(x(0, n), scene.body.committed.x(0, n) + 0.25);
    }
  }
}

}  // namespace
}  // namespace argil::solid
