// Eight tets at once against the law of a single point, in batches that are full and not.
#include "solid/tet_lanes.h"

#include <Eigen/Geometry>

#include <vector>

#include <gtest/gtest.h>

#include "base/mandel.h"
#include "base/ordered_loops.h"
#include "base/rng.h"
#include "solid/element.h"

namespace argil::solid {
namespace {

constexpr int kTets = 2 * kLanes + 3;

/// Tets that are turned by any angle, stretched, flat, inverted; every third without plastic strain.
struct Tets {
  Points x{3, 4 * kTets};
  Eigen::Matrix4Xi nodes{4, kTets};
  Eigen::Matrix3Xd gradient{3, 4 * kTets}, turned{3, 4 * kTets}, force{3, 4 * kTets};
  Eigen::Matrix3Xd F{3, 3 * kTets}, R{3, 3 * kTets}, frame{3, 3 * kTets};
  double tolerance = 0.0;
  TensorField strain{6, kTets}, plastic{6, kTets};
  Field volume_ratio{kTets}, weight{kTets}, lambda{kTets}, mu{kTets};
  Field excess_bulk{kTets}, volume_change{kTets}, pressure{kTets};
  std::vector<char> is_turned = std::vector<char>(kTets, 0);

  Tets() {
    Rng rng(3);
    for (int t = 0; t < kTets; ++t) {
      Mat34 rest;
      rest << 0, 1, 0.1, 0.2, 0, 0.1, 1.2, 0.3, 0, -0.1, 0.2, 0.9;
      for (int i = 0; i < 12; ++i) rest(i) += rng.uniform(-0.1, 0.1);
      const TetGeometry tet = make_tet_geometry(rest);
      gradient.middleCols<4>(4 * t) = tet.gradient;
      weight(t) = tet.volume;
      const Vec3 turn(rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0));
      Mat3 motion = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
      for (int k = 0; k < 9; ++k) motion(k) += rng.uniform(-0.3, 0.3);
      if (t % 5 == 3) motion.col(2) *= -1.0;
      if (t % 5 == 4) motion.col(2) = motion.col(0) + 1e-10 * motion.col(1);
      x.middleCols<4>(4 * t) = motion * rest;
      for (int i = 0; i < 4; ++i) nodes(i, t) = 4 * t + i;
      for (int k = 0; k < 6; ++k) plastic(k, t) = t % 3 == 0 ? 0.0 : rng.uniform(-0.2, 0.2);
      lambda(t) = rng.uniform(1e3, 1e5);
      mu(t) = rng.uniform(1e3, 1e5);
      excess_bulk(t) = rng.uniform(1e3, 1e6);
      volume_change(t) = rng.uniform(-0.1, 0.1);
    }
    pressure = excess_bulk.cwiseProduct(volume_change);
    turned.setZero();
    frame.setZero();
  }
  void move(StrainModel model) {
    const PointArrays arrays{x.data(),  nodes.data(),  gradient.data(),     model == StrainModel::linear,
                           F.data(),  R.data(),      turned.data(),       frame.data(),
                           tolerance, strain.data(), volume_ratio.data(), is_turned.data()};
    OrderedRuns(1).each(
        kTets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_motions(arrays, begin, end); });
  }
  void press(StrainModel model, bool with_pressure) {
    const ForceArrays arrays{gradient.data(),
                             R.data(),
                             strain.data(),
                             plastic.data(),
                             weight.data(),
                             lambda.data(),
                             mu.data(),
                             with_pressure ? pressure.data() : nullptr,
                             model == StrainModel::linear,
                             force.data()};
    OrderedRuns(1).each(
        kTets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_corner_forces(arrays, begin, end); });
  }
};

class Lanes8 : public testing::TestWithParam<StrainModel> {};

TEST_P(Lanes8, MoveAndPressAsTheLawOfAPointDoes) {
  Tets tets;
  tets.move(GetParam());
  Eigen::Matrix3Xd forces[2];
  for (const bool with_pressure : {false, true}) {
    tets.press(GetParam(), with_pressure);
    forces[with_pressure] = tets.force;
  }
  for (int t = 0; t < kTets; ++t) {
    const Mat34 gradient = tets.gradient.middleCols<4>(4 * t);
    const Mat3 F = compute_deformation_gradient(tets.x.middleCols<4>(4 * t), gradient);
    const PointMotion motion = make_motion(GetParam(), F);
    EXPECT_LT((tets.F.middleCols<3>(3 * t) - F).norm(), 1e-14) << t;
    EXPECT_NEAR(tets.volume_ratio(t), F.determinant(), 1e-14) << t;
    if (t % 5 == 4) continue;  // flat: the rotation about the fold is any
    EXPECT_LT((tets.R.middleCols<3>(3 * t) - motion.R).norm(), 1e-13) << t;
    EXPECT_LT((tets.turned.middleCols<4>(4 * t) - motion.R * gradient).norm(), 1e-12) << t;
    EXPECT_LT((tets.strain.col(t) - compute_strain(F, motion.R)).norm(), 1e-13) << t;
    Elasticity e{tets.lambda(t), tets.mu(t)};
    for (const bool with_pressure : {false, true}) {
      e.excess_bulk = with_pressure ? tets.excess_bulk(t) : 0.0;
      e.volume_change = tets.volume_change(t);
      const Mat34 expected =
          compute_element_force({gradient, tets.weight(t)}, GetParam(), motion, tets.plastic.col(t), e);
      EXPECT_LT((forces[with_pressure].middleCols<4>(4 * t) - expected).norm(),
                1e-12 * (1.0 + expected.norm()))
          << t;
    }
  }
}

/// A small displacement of turned tets, and the force of its strain alone.
TEST_P(Lanes8, StrainBySmallDisplacementsInTheTurnedFrame) {
  Tets tets;
  tets.move(GetParam());
  Points u = Points::Zero(3, tets.x.cols());
  Rng rng(7);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = rng.uniform(-1.0, 1.0);
  const StrainArrays strains{u.data(), tets.nodes.data(), tets.gradient.data(), tets.R.data(),
                             tets.strain.data()};
  OrderedRuns(1).each(
      kTets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_strains(strains, begin, end); });
  const ForceArrays forces{tets.gradient.data(),
                           tets.R.data(),
                           tets.strain.data(),
                           nullptr,
                           tets.weight.data(),
                           tets.lambda.data(),
                           tets.mu.data(),
                           nullptr,
                           GetParam() == StrainModel::linear,
                           tets.force.data()};
  OrderedRuns(1).each(
      kTets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_corner_forces(forces, begin, end); });
  for (int t = 0; t < kTets; ++t) {
    const Mat34 gradient = tets.gradient.middleCols<4>(4 * t);
    const Mat3 R = tets.R.middleCols<3>(3 * t);
    const Vec6 strain = compute_strain(R + u.middleCols<4>(4 * t) * gradient.transpose(), R);
    const Mat3 sigma = from_mandel(compute_stress({tets.lambda(t), tets.mu(t)}, strain));
    const Mat34 force = tets.weight(t) * R * sigma * gradient;
    EXPECT_LT((tets.strain.col(t) - strain).norm(), 1e-13 * (1.0 + strain.norm())) << t;
    EXPECT_LT((tets.force.middleCols<4>(4 * t) - force).norm(), 1e-12 * (1.0 + force.norm())) << t;
  }
}

TEST_P(Lanes8, NameTheTetsWhoseFrameChanged) {
  Tets tets;
  tets.move(GetParam());
  EXPECT_EQ(tets.is_turned, std::vector<char>(kTets, 1));
  tets.is_turned.assign(kTets, 0);
  constexpr int kMoved = kLanes + 1;
  tets.x.col(4 * kMoved) += Vec3(0.01, -0.02, 0.03);
  tets.move(GetParam());
  std::vector<char> expected(kTets, 0);
  if (GetParam() == StrainModel::corotational) expected[kMoved] = 1;  // the linear law has one frame for ever
  EXPECT_EQ(tets.is_turned, expected);
}

TEST(Lanes8, KeepAFrameUntilTheRotationHasLeftIt) {
  Tets tets;
  tets.move(StrainModel::corotational);
  const Tets before = tets;
  tets.is_turned.assign(kTets, 0);
  tets.tolerance = 0.01;
  constexpr int kLittle = kLanes + 1, kMuch = 3;
  const auto turn = [&](int tet, double angle) {
    tets.x.middleCols<4>(4 * tet) =
        Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix() * tets.x.middleCols<4>(4 * tet).eval();
  };
  turn(kLittle, 0.006);
  turn(kMuch, 0.02);
  tets.move(StrainModel::corotational);
  std::vector<char> expected(kTets, 0);
  expected[kMuch] = 1;
  EXPECT_EQ(tets.is_turned, expected);
  const auto change = [&](int tet) {
    return (tets.turned - before.turned).middleCols<4>(4 * tet).cwiseAbs().maxCoeff();
  };
  EXPECT_EQ(change(kLittle), 0.0);
  EXPECT_GT(change(kMuch), 0.001);
  EXPECT_NEAR((tets.R - before.R).middleCols<3>(3 * kLittle).norm(), 0.006 * std::sqrt(2.0), 1e-6);
  turn(kLittle, 0.006);  // what it has turned since its frame was made counts, not the last step
  tets.move(StrainModel::corotational);
  EXPECT_EQ(tets.is_turned[kLittle], 1);
  EXPECT_EQ((tets.frame - tets.R).middleCols<3>(3 * kLittle).norm(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Every, Lanes8, testing::Values(StrainModel::linear, StrainModel::corotational),
                         [](const auto& instance) {
                           return instance.param == StrainModel::linear ? "linear" : "corotational";
                         });

}  // namespace
}  // namespace argil::solid
