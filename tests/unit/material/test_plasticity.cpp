// Müller–Gross flow [Mueller2004] at one point, and the clay kernel, eq. 9.
#include "material/plasticity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/mandel.h"
#include "base/rng.h"

namespace argil::material {
namespace {

Plasticity make_law() {
  Plasticity law;
  law.yield = 0.02;
  law.creep_per_s = 10.0;
  law.max = 0.5;
  law.deviatoric = false;
  return law;
}

Vec6 make_strain(std::uint64_t seed, double size) {
  Rng rng(seed, "strain");
  Vec6 e;
  for (int i = 0; i < 6; ++i) e(i) = rng.uniform(-1.0, 1.0);
  return size * e.normalized();
}

TEST(PlasticFlow, DoesNotHappenBelowTheYieldNorm) {
  const Plasticity law = make_law();
  const Vec6 before = make_strain(1, 0.1);
  const Vec6 direction = make_strain(2, 1.0);
  EXPECT_EQ(compute_plastic_strain(before + 0.01999 * direction, before, law.yield, law, 0.01), before);
  EXPECT_NE(compute_plastic_strain(before + 0.02001 * direction, before, law.yield, law, 0.01), before);
}

TEST(PlasticFlow, InRateFormRelaxesHeldStrainExponentially) {
  // dε_p/dt = c ε_e at held strain: ε_e(t) = ε e^{−ct}; any number of steps gives the same.
  const Plasticity law = make_law();
  const Vec6 strain = make_strain(3, 0.3);
  for (const int steps : {1, 7, 100}) {
    Vec6 plastic = Vec6::Zero();
    for (int i = 0; i < steps; ++i)
      plastic = compute_plastic_strain(strain, plastic, law.yield, law, 0.1 / steps);
    EXPECT_LT((plastic - (1.0 - std::exp(-1.0)) * strain).norm(), 1e-15 * steps);
  }
}

TEST(PlasticFlow, InLiteralFormIsForwardEuler) {
  Plasticity law = make_law();
  law.form = FlowForm::literal;
  const Vec6 strain = make_strain(4, 0.1);
  const Vec6 before = make_strain(5, 0.03);
  const Vec6 after = compute_plastic_strain(strain, before, law.yield, law, 0.014);
  EXPECT_LT((after - (before + 0.14 * (strain - before))).norm(), 1e-16);
}

TEST(PlasticFlow, StopsAtTheCap) {
  const Plasticity law = make_law();
  const Vec6 strain = make_strain(6, 2.0);
  const Vec6 plastic = compute_plastic_strain(strain, Vec6::Zero(), law.yield, law, 10.0);
  EXPECT_NEAR(plastic.norm(), law.max, 1e-15);
  EXPECT_LT((plastic.normalized() - strain.normalized()).norm(), 1e-15);
  EXPECT_LT((compute_plastic_strain(strain, plastic, law.yield, law, 10.0) - plastic).norm(), 1e-15);
}

TEST(PlasticFlow, WhenDeviatoricKeepsTheVolumeAndYieldsOnTheDeviator) {
  Plasticity law = make_law();
  law.deviatoric = true;
  Vec6 pressure = Vec6::Zero();
  pressure.head<3>().setConstant(-0.4);
  EXPECT_EQ(compute_plastic_strain(pressure, Vec6::Zero(), law.yield, law, 0.01), Vec6::Zero());
  const Vec6 strain = pressure + make_strain(8, 0.2);
  const Vec6 after = compute_plastic_strain(strain, Vec6::Zero(), law.yield, law, 0.01);
  EXPECT_GT(after.norm(), 0.0);
  EXPECT_NEAR(after.head<3>().sum(), 0.0, 1e-16);
}

TEST(PlasticFlow, WhenDeviatoricNeverCreatesEnergy) {
  // At held strain the elastic energy is μ‖dev ε_e‖² + const. True for the cap too: it is a projection on a
  // ball.
  Plasticity law = make_law();
  law.deviatoric = true;
  law.max = 0.1;
  Vec6 plastic = Vec6::Zero();
  const auto energy = [](Vec6 e) {
    e.head<3>().array() -= e.head<3>().sum() / 3.0;
    return e.squaredNorm();
  };
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec6 strain = make_strain(100 + i, 0.3);
    const Vec6 after = compute_plastic_strain(strain, plastic, law.yield, law, 0.05);
    EXPECT_LE(energy(strain - after), energy(strain - plastic) * (1.0 + 1e-14));
    EXPECT_LE(after.norm(), law.max * (1.0 + 1e-15));
    plastic = after;
  }
}

TEST(PlasticFlow, InFrobeniusNormDoesNotSeeTheFrameAndInVoigt6NormDoes) {
  Plasticity law = make_law();
  // Pure shear 0.018·√2 in Frobenius norm. As diag(γ, −γ, 0) its six components have norm √2 γ, turned by 45°
  // γ.
  const double gamma = 0.018;
  Vec6 straight = Vec6::Zero();
  straight(0) = gamma;
  straight(1) = -gamma;
  Vec6 turned = Vec6::Zero();
  turned(5) = kSqrt2 * gamma;
  const auto flows = [&](const Vec6& e) {
    return compute_plastic_strain(e, Vec6::Zero(), law.yield, law, 0.01).norm() > 0.0;
  };
  EXPECT_TRUE(flows(straight));
  EXPECT_TRUE(flows(turned));
  law.norm = StrainNorm::voigt6;
  EXPECT_TRUE(flows(straight));
  EXPECT_FALSE(flows(turned));
}

TEST(ClayKernel, IsEquationNine) {
  ClayKernel kernel{KernelForm::per_step, 30.0, 50.0, 0.02, 0.014};
  EXPECT_DOUBLE_EQ(compute_clay_weight(0.0, kernel), 1.0);
  EXPECT_DOUBLE_EQ(compute_clay_weight(0.01, kernel), 1.0 / 1.3);
  EXPECT_DOUBLE_EQ(compute_clay_weight(0.02, kernel), 1.0 / (1.6 + std::exp(1.0)));  // R_D itself is outside
  EXPECT_DOUBLE_EQ(compute_clay_weight(0.04, kernel), 1.0 / (2.2 + std::exp(2.0)));
}

TEST(ClayKernel, GoesToZeroFarAwayWithoutOverflow) {
  const ClayKernel kernel{KernelForm::rate, 1.0, 1e3, 0.01, 0.014};
  double last = 1.0;
  for (double r = 0.02; r < 3.0; r += 0.001) {
    const double weight = compute_clay_weight(r, kernel);
    EXPECT_TRUE(weight >= 0.0 && weight <= last) << r;
    last = weight;
  }
  EXPECT_EQ(compute_clay_weight(1e6, kernel), 0.0);
  EXPECT_EQ(compute_clay_factor(1e6, kernel, 0.001), 0.0);
  EXPECT_GT(compute_clay_weight(0.69, kernel), 0.0);
}

TEST(ClayKernel, InRateFormDoesNotDependOnTheStep) {
  ClayKernel kernel{KernelForm::rate, 30.0, 50.0, 0.02, 0.014};
  const double once = compute_clay_factor(0.03, kernel, 0.014);
  EXPECT_DOUBLE_EQ(once, compute_clay_weight(0.03, kernel));
  EXPECT_NEAR(std::pow(compute_clay_factor(0.03, kernel, 0.001), 14.0), once, 1e-15);
  kernel.form = KernelForm::per_step;
  EXPECT_DOUBLE_EQ(compute_clay_factor(0.03, kernel, 0.001), once);
  kernel.form = KernelForm::off;
  EXPECT_EQ(compute_clay_factor(0.03, kernel, 0.001), 1.0);
}

}  // namespace
}  // namespace argil::material
