// Clay of large strain at a point, carried through long paths: closed forms of elastic, perfectly plastic
// clay by von Mises's law.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>

#include <gtest/gtest.h>

#include "base/rng.h"
#include "material/plasticity.h"
#include "solid/hencky_lanes.h"
#include "solid/law.h"

namespace argil::solid {
namespace {

constexpr double kStrength = 15e3;  // c_u [Pa]
constexpr material::Elastic kDry{1.2e6, 0.3};
constexpr double kMu = kDry.youngs_modulus / (2.0 * (1.0 + kDry.poissons_ratio));

Elasticity make_elasticity() {
  return {2.0 * kMu * kDry.poissons_ratio / (1.0 - 2.0 * kDry.poissons_ratio), kMu};
}

/// A point that is moved and flows.
struct Point {
  Mat3 F = Mat3::Identity();
  Vec6 plastic_strain = Vec6::Zero();
  double yield = 0.0;
  double dissipated = 0.0;  ///< [J/m³]
  double least_loss = 0.0;  ///< of any step
  material::FlowRule rule;

  Point() {
    material::Plasticity law;
    law.strength = kStrength;
    yield = material::compute_yield_strain(law, kDry);
  }
  PointMotion motion() const { return make_motion(StrainModel::hencky, F); }
  Mat3 piola() const {
    return compute_piola(StrainModel::hencky, motion(), plastic_strain, make_elasticity());
  }
  double energy() const {
    return compute_energy_density(StrainModel::hencky, motion(), plastic_strain, make_elasticity());
  }
  Mat3 true_stress() const { return piola() * F.transpose() / F.determinant(); }
  void move_to(const Mat3& next) {
    F = next;
    const PointMotion m = motion();
    const Vec6 strain = compute_strain(m.F, m.R);
    double lost[8] = {};
    flow_by_hencky({strain.data(), plastic_strain.data(), &yield, rule}, 0, 1, lost);
    dissipated += kMu * lost[0];
    least_loss = std::min(least_loss, lost[0]);
  }
};

TEST(HenckyFlow, ABarThatIsDrawnHasTheStrengthInTension) {
  // σ_y = √3 c_u, whatever the stretch: twice as long, and half as long.
  for (const double goal : {2.0, 0.5}) {
    Point point;
    constexpr int kSteps = 100;  // each of a third of the elastic strain
    for (int i = 1; i <= kSteps; ++i) {
      const double s = std::pow(goal, static_cast<double>(i) / kSteps);
      point.move_to(Vec3(s, 1.0 / std::sqrt(s), 1.0 / std::sqrt(s)).asDiagonal());
    }
    const Mat3 stress = point.true_stress();
    const double sign = goal > 1.0 ? 1.0 : -1.0;
    EXPECT_NEAR(stress(0, 0) - stress(1, 1), sign * std::sqrt(3.0) * kStrength, 1e-10 * kStrength);
    EXPECT_NEAR(stress(1, 1), stress(2, 2), 1e-10 * kStrength);
    // What is plastic of it: all but the elastic c_u/(√3 G) = ε₁ − ε₂ over 3/2.
    const double elastic = kStrength / (std::sqrt(3.0) * kMu);
    EXPECT_NEAR(point.plastic_strain(0), std::log(goal) - sign * elastic, 1e-13);
    EXPECT_NEAR(point.plastic_strain(1), -0.5 * point.plastic_strain(0), 1e-13);
    EXPECT_NEAR(point.dissipated, std::sqrt(3.0) * kStrength * std::abs(point.plastic_strain(0)),
                1e-9 * point.dissipated);
  }
}

TEST(HenckyFlow, ShearedByThreeHundredPercentItBearsItsShearStrength) {
  Point point;
  Mat3 F = Mat3::Identity();
  for (int i = 1; i <= 3000; ++i) {
    F(0, 1) = 1e-3 * i;
    point.move_to(F);
    if (F(0, 1) > 0.2) {  // elastic strain is (c_u/G)² = 1e-3 beside 1
      EXPECT_NEAR(point.true_stress()(0, 1), kStrength, 2e-3 * kStrength) << i;
    }
  }
  const Mat3 F_p = from_mandel(point.plastic_strain).exp();
  EXPECT_NEAR(F_p.determinant(), 1.0, 1e-12);
  EXPECT_EQ(point.least_loss, 0.0);
}

TEST(HenckyFlow, ShearedFasterItIsAsMuchStrongerAsThereAreDecades) {
  // [Einav2005]: c_u (1 + a log₁₀(γ̇/γ̇₀)) in steady shear, where all of γ̇ is plastic; c_u at γ̇₀ and below.
  material::Plasticity law;
  law.form = material::FlowForm::j2;
  law.rate_growth = 0.12;
  law.reference_rate = 0.02;
  constexpr double kShear = 0.4, kPerStep = 1e-3;
  for (const double decades : {-2.0, 0.0, 0.5, 1.0, 3.0, 6.0}) {
    Point point;
    const double step_s = kPerStep / (law.reference_rate * std::pow(10.0, decades));
    point.rule = material::make_flow_rule(law, step_s);
    Mat3 F = Mat3::Identity();
    while (F(0, 1) < kShear) {
      F(0, 1) += kPerStep;
      point.move_to(F);
    }
    const double strength = kStrength * (1.0 + law.rate_growth * std::max(0.0, decades));
    EXPECT_NEAR(point.true_stress()(0, 1), strength, 3e-3 * strength) << decades;  // elastic strain is finite
    EXPECT_EQ(point.least_loss, 0.0);
  }
}

TEST(HenckyFlow, EndsWhereItsStrainCanNotBeWrittenAnyMore) {
  // A shear of 10⁹ has logarithms of ±21, whose exponentials no number holds beside 1.
  Point point;
  Mat3 F = Mat3::Identity();
  for (double shear = 1e-2; shear < 1e9; shear *= 1.02) {
    F(0, 1) = shear;
    point.move_to(F);
    ASSERT_TRUE(point.plastic_strain.allFinite()) << shear;
    ASSERT_LE(point.plastic_strain.norm(), 8.0) << shear;
  }
  EXPECT_GT(point.plastic_strain.norm(), 7.9);
}

TEST(HenckyFlow, DoesNotFeelATurnOfTheWhole) {
  Point still, turned;
  Rng rng(9);
  const Vec3 axis = Vec3(1.0, -2.0, 0.5).normalized();
  Mat3 H = Mat3::Zero();
  for (int k = 0; k < 9; ++k) H(k) = rng.uniform(-0.5, 0.5);
  for (int i = 1; i <= 50; ++i) {
    const Mat3 F = Mat3::Identity() + i / 50.0 * H;
    still.move_to(F);
    turned.move_to(Eigen::AngleAxisd(0.11 * i, axis).toRotationMatrix() * F);
  }
  EXPECT_GT(still.plastic_strain.norm(), 0.2);
  EXPECT_LT((still.plastic_strain - turned.plastic_strain).norm(), 1e-12);
}

/// What a motion there and back, in so many steps, leaves over of the work put in, over that.
double find_imbalance(int steps) {
  Point point;
  const Mat3 H = (Mat3() << 0.3, 0.8, -0.1, 0.0, -0.2, 0.4, 0.2, 0.1, -0.15).finished();
  double work = 0.0;
  for (int i = 1; i <= steps; ++i) {
    const Mat3 before = point.F, stress_before = point.piola();
    point.move_to(Mat3::Identity() + std::sin(4.0 * i / steps) * H);
    work += 0.5 * (stress_before + point.piola()).cwiseProduct(point.F - before).sum();
  }
  EXPECT_EQ(point.least_loss, 0.0);
  EXPECT_GT(point.energy(), 0.0);
  return (point.dissipated + point.energy()) / work - 1.0;
}

TEST(HenckyFlow, WhatIsPutInIsStoredOrLostToSecondOrderInTheStep) {
  const double coarse = find_imbalance(4000), fine = find_imbalance(8000);
  EXPECT_LT(std::abs(coarse), 1e-4);
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

TEST(HenckyFlow, BelowItsStrengthItIsElastic) {
  Point point;
  point.move_to(Vec3(1.0 + 0.9 * kStrength / (std::sqrt(3.0) * kMu), 1.0, 1.0).asDiagonal());
  EXPECT_TRUE(point.plastic_strain.isZero(0.0));
  point.move_to(0.5 * Mat3::Identity());  // pressure alone
  EXPECT_TRUE(point.plastic_strain.isZero(0.0));
}

}  // namespace
}  // namespace argil::solid
