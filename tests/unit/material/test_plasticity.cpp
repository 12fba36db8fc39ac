// Müller–Gross flow [Mueller2004] at one point, and the clay kernel, eq. 9.
#include "material/plasticity.h"

#include <gtest/gtest.h>

#include <algorithm>
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
  EXPECT_EQ(compute_plastic_strain(before + 0.01999 * direction, before, {law.yield}, law, 0.01), before);
  EXPECT_NE(compute_plastic_strain(before + 0.02001 * direction, before, {law.yield}, law, 0.01), before);
}

TEST(PlasticFlow, InRateFormRelaxesHeldStrainExponentially) {
  // dε_p/dt = c ε_e at held strain: ε_e(t) = ε e^{−ct}; any number of steps gives the same.
  const Plasticity law = make_law();
  const Vec6 strain = make_strain(3, 0.3);
  for (const int steps : {1, 7, 100}) {
    Vec6 plastic = Vec6::Zero();
    for (int i = 0; i < steps; ++i)
      plastic = compute_plastic_strain(strain, plastic, {law.yield}, law, 0.1 / steps);
    EXPECT_LT((plastic - (1.0 - std::exp(-1.0)) * strain).norm(), 1e-15 * steps);
  }
}

TEST(PlasticFlow, ToYieldStopsThereHoweverTheTimeIsCut) {
  // ‖ε_e‖ falls as e^{−ct} until it is the yield norm, reached at t = ln(15)/c, and stays.
  Plasticity law = make_law();
  law.form = FlowForm::rate_to_yield;
  const Vec6 strain = make_strain(3, 0.3);
  for (const double time : {0.1, 0.27, 0.28, 3.0}) {
    const double left = std::max(0.3 * std::exp(-10.0 * time), law.yield);
    for (const int steps : {1, 7, 100}) {
      Vec6 plastic = Vec6::Zero();
      for (int i = 0; i < steps; ++i)
        plastic = compute_plastic_strain(strain, plastic, {law.yield}, law, time / steps);
      EXPECT_LT((strain - plastic - left / 0.3 * strain).norm(), 1e-15 * steps) << time << " " << steps;
    }
  }
}

TEST(PlasticFlow, InRateFormGoesPastTheYieldNormByLessThanAStep) {
  // After the step that crosses it, yield e^{−c h} < ‖ε_e‖ ≤ yield: an error of first order in h.
  const Plasticity law = make_law();
  const Vec6 strain = make_strain(3, 0.3);
  for (const double step : {0.05, 0.01, 0.001}) {
    Vec6 plastic = Vec6::Zero();
    for (int i = 0; i < 0.5 / step; ++i)
      plastic = compute_plastic_strain(strain, plastic, {law.yield}, law, step);
    const double left = (strain - plastic).norm();
    EXPECT_LE(left, law.yield);
    EXPECT_GT(left, law.yield * std::exp(-law.creep_per_s * step));
  }
}

TEST(PlasticFlow, InLiteralFormIsForwardEuler) {
  Plasticity law = make_law();
  law.form = FlowForm::literal;
  const Vec6 strain = make_strain(4, 0.1);
  const Vec6 before = make_strain(5, 0.03);
  const Vec6 after = compute_plastic_strain(strain, before, {law.yield}, law, 0.014);
  EXPECT_LT((after - (before + 0.14 * (strain - before))).norm(), 1e-16);
}

TEST(PlasticFlow, StopsAtTheCap) {
  const Plasticity law = make_law();
  const Vec6 strain = make_strain(6, 2.0);
  const Vec6 plastic = compute_plastic_strain(strain, Vec6::Zero(), {law.yield}, law, 10.0);
  EXPECT_NEAR(plastic.norm(), law.max, 1e-15);
  EXPECT_LT((plastic.normalized() - strain.normalized()).norm(), 1e-15);
  EXPECT_LT((compute_plastic_strain(strain, plastic, {law.yield}, law, 10.0) - plastic).norm(), 1e-15);
}

TEST(PlasticFlow, WhenDeviatoricKeepsTheVolumeAndYieldsOnTheDeviator) {
  Plasticity law = make_law();
  law.deviatoric = true;
  Vec6 pressure = Vec6::Zero();
  pressure.head<3>().setConstant(-0.4);
  EXPECT_EQ(compute_plastic_strain(pressure, Vec6::Zero(), {law.yield}, law, 0.01), Vec6::Zero());
  const Vec6 strain = pressure + make_strain(8, 0.2);
  const Vec6 after = compute_plastic_strain(strain, Vec6::Zero(), {law.yield}, law, 0.01);
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
    const Vec6 after = compute_plastic_strain(strain, plastic, {law.yield}, law, 0.05);
    EXPECT_LE(energy(strain - after), energy(strain - plastic) * (1.0 + 1e-14));
    EXPECT_LE(after.norm(), law.max * (1.0 + 1e-15));
    plastic = after;
  }
}

/// Clay with a preferred axis: soft along it, and strongly coupled to the volume.
Mat6 make_layered_stiffness() {
  Mat6 C = Mat6::Zero();
  C.topLeftCorner<3, 3>() << 9, 5, 1, 5, 9, 1, 1, 1, 2;
  C.diagonal().tail<3>() << 1.5, 1.5, 4;
  const Mat3 Q = Eigen::AngleAxisd(0.7, Vec3(2, -1, 2) / 3.0).toRotationMatrix();
  Mat6 turn;
  for (int k = 0; k < 6; ++k) turn.col(k) = to_mandel(Q * from_mandel(Vec6::Unit(k)) * Q.transpose());
  return turn * C * turn.transpose();
}

TEST(PlasticFlow, AlongTheStressDeviatorCreatesNoEnergyInAnisotropicClay) {
  // ½ ε_e:C:ε_e falls for every f in [0, 1]; along the strain's deviator it does not.
  const Mat6 C = make_layered_stiffness();
  const double shape_stiffness = compute_shape_stiffness(C);
  Plasticity law = make_law();
  law.deviatoric = true;
  law.max = 0.1;
  int created = 0;
  for (const FlowForm form : {FlowForm::rate, FlowForm::rate_to_yield, FlowForm::literal}) {
    law.form = form;
    law.creep_per_s = form == FlowForm::literal ? 19.9 : 40.0;
    Vec6 plastic = Vec6::Zero();
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Vec6 strain = plastic + make_strain(100 + i, 0.3);
      const auto energy = [&](const Vec6& after) { return 0.5 * (strain - after).dot(C * (strain - after)); };
      const Vec6 drive = compute_stress_drive(C * (strain - plastic), shape_stiffness);
      const Vec6 after = compute_plastic_strain(strain, plastic, {law.yield, &drive}, law, 0.05);
      const Vec6 along_strain = compute_plastic_strain(strain, plastic, {law.yield}, law, 0.05);
      EXPECT_LE(energy(after), energy(plastic) * (1.0 + 1e-14));
      EXPECT_NEAR(after.head<3>().sum(), 0.0, 1e-15);  // rounding of up to ten steps
      EXPECT_LE(after.norm(), law.max * (1.0 + 1e-14));
      created += energy(along_strain) > energy(plastic) ? 1 : 0;
      plastic = i % 10 == 0 ? Vec6(Vec6::Zero()) : after;
    }
  }
  EXPECT_GT(created, 100);
}

TEST(StressDrive, OfAnIsotropicStiffnessIsTheDeviatorOfTheStrain) {
  Mat6 C = 2.0 * 3e4 * Mat6::Identity();
  C.topLeftCorner<3, 3>().array() += 7e4;
  const Vec6 e = make_strain(11, 0.2);
  Vec6 expected = e;
  expected.head<3>().array() -= e.head<3>().sum() / 3.0;
  EXPECT_NEAR(compute_shape_stiffness(C), 6e4, 1e-10);
  EXPECT_LT((compute_stress_drive(C * e, compute_shape_stiffness(C)) - expected).norm(), 1e-16);
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
    return compute_plastic_strain(e, Vec6::Zero(), {law.yield}, law, 0.01).norm() > 0.0;
  };
  EXPECT_TRUE(flows(straight));
  EXPECT_TRUE(flows(turned));
  law.norm = StrainNorm::voigt6;
  EXPECT_TRUE(flows(straight));
  EXPECT_FALSE(flows(turned));
}

constexpr double kLambda = 3.0;
constexpr double kMu = 2.0;
constexpr double kYield = 0.01;

Plasticity make_j2() {
  Plasticity law;
  law.form = FlowForm::j2;
  law.yield = kYield;
  law.max = 10.0;
  return law;
}

TEST(J2Flow, FollowsAShearCycleOfPerfectPlasticity) {
  // dτ = μ dγ between ±τ_y, τ_y = √2 μ·yield. A closed cycle dissipates 4 τ_y (γ₀ − γ_y), however it is cut.
  const double tau_yield = kSqrt2 * kMu * kYield;
  const double amplitude = 0.05;
  for (const int steps : {4, 40, 400}) {
    Vec6 plastic = Vec6::Zero();
    double tau = 0.0;
    double gamma = 0.0;
    double dissipated = 0.0;
    // A quarter up, then two full cycles of which the last is counted.
    for (int k = 1; k <= 9 * steps; ++k) {
      const double phase = static_cast<double>(k) / steps;  // in quarters
      const double next = amplitude * (1.0 - std::abs(std::fmod(phase + 1.0, 4.0) - 2.0));
      tau = std::clamp(tau + kMu * (next - gamma), -tau_yield, tau_yield);
      gamma = next;
      Vec6 strain = Vec6::Zero();
      strain(5) = gamma / kSqrt2;
      const Vec6 before = plastic;
      plastic = compute_plastic_strain(strain, plastic, {kYield}, make_j2(), 0.0);
      EXPECT_NEAR(2.0 * kMu * (strain - plastic)(5) / kSqrt2, tau, 1e-15) << k;
      if (k > 5 * steps) dissipated += 2.0 * kMu * (strain - plastic).dot(plastic - before);
    }
    EXPECT_NEAR(dissipated, 4.0 * tau_yield * (amplitude - tau_yield / kMu), 1e-14) << steps;
  }
}

TEST(J2Flow, FollowsAUniaxialCycleBetweenPlusAndMinusTheTensileStrength) {
  // Axial strain prescribed, the lateral one found so that the lateral stress vanishes: σ = clamp(σ + E dε,
  // ±σ_y).
  const double E = kMu * (3.0 * kLambda + 2.0 * kMu) / (kLambda + kMu);
  const double strength = std::sqrt(6.0) * kMu * kYield;
  const auto stress = [](const Vec6& elastic) {
    Vec6 sigma = 2.0 * kMu * elastic;
    sigma.head<3>().array() += kLambda * elastic.head<3>().sum();
    return sigma;
  };
  Vec6 plastic = Vec6::Zero();
  double expected = 0.0;
  double axial = 0.0;
  for (const double next : {0.005, 0.02, 0.05, 0.045, 0.0, -0.03, -0.02, 0.01, 0.04}) {
    expected = std::clamp(expected + E * (next - axial), -strength, strength);
    axial = next;
    double low = -1.0;
    double high = 1.0;
    Vec6 strain = Vec6::Zero();
    for (int k = 0; k < 60; ++k) {
      const double lateral = 0.5 * (low + high);
      strain.head<3>() = Vec3(axial, lateral, lateral);
      const Vec6 after = compute_plastic_strain(strain, plastic, {kYield}, make_j2(), 0.0);
      (stress(strain - after)(1) > 0.0 ? high : low) = lateral;
    }
    plastic = compute_plastic_strain(strain, plastic, {kYield}, make_j2(), 0.0);
    EXPECT_NEAR(stress(strain - plastic)(0), expected, 1e-14) << next;
    EXPECT_NEAR(plastic.head<3>().sum(), 0.0, 1e-16);
  }
}

TEST(J2Flow, StopsWhereTheStrengthOfItsOwnRateIsReached) {
  // From the flow that is wanted to the norm that it takes: ‖ε_e‖ = Δ + y (1 + a log₁₀(Δ/Δ₀)).
  const FlowRule rule{1.0, true, 0.15, 1e-7};
  for (const double yield : {1e-6, 1e-3, 0.3})
    for (const double flow : {1.001e-7, 1e-6, 1e-4, 0.02, 3.0}) {
      const double norm = flow + yield * (1.0 + rule.growth * std::log10(flow / rule.reference_flow));
      EXPECT_NEAR(norm * rule.find_share(norm, yield), flow, 1e-12 * (flow + yield)) << yield << ' ' << flow;
    }
  // Slower it is rate independent, to the bit, and the strength has no jump where the rate begins to count.
  const FlowRule independent;
  EXPECT_EQ(rule.find_share(0.1 + 0.5e-7, 0.1), independent.find_share(0.1 + 0.5e-7, 0.1));
  EXPECT_NEAR(rule.find_share(0.1 + 1.0001e-7, 0.1), independent.find_share(0.1 + 1e-7, 0.1), 1e-9);
}

TEST(J2Flow, ASecondUpdateIsNone) {
  const Vec6 strain = make_strain(6, 0.3);
  const Vec6 once = compute_plastic_strain(strain, Vec6::Zero(), {kYield}, make_j2(), 0.0);
  EXPECT_LT((compute_plastic_strain(strain, once, {kYield}, make_j2(), 0.0) - once).norm(), 1e-16);
}

TEST(EveryFlow, TurnsWithTheBody) {
  const Mat3 Q = Eigen::AngleAxisd(0.9, Vec3(1, 2, -2) / 3.0).toRotationMatrix();
  const auto turn = [&](const Vec6& e) { return to_mandel(Q * from_mandel(e) * Q.transpose()); };
  for (const FlowForm form : {FlowForm::rate, FlowForm::rate_to_yield, FlowForm::literal, FlowForm::j2})
    for (const bool deviatoric : {true, false}) {
      Plasticity law = make_law();
      law.form = form;
      law.deviatoric = deviatoric || form == FlowForm::j2;
      const Vec6 strain = make_strain(7, 0.2);
      const Vec6 before = make_strain(8, 0.05);
      const Vec6 after = compute_plastic_strain(strain, before, {law.yield}, law, 0.01);
      EXPECT_LT(
          (compute_plastic_strain(turn(strain), turn(before), {law.yield}, law, 0.01) - turn(after)).norm(),
          1e-15);
    }
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

TEST(FindFlowing, NamesThePointsThatTheLawLetsFlow) {
  constexpr int kPoints = 61;  // the last batch is not full
  Rng rng(5);
  TensorField strain(6, kPoints), plastic(6, kPoints);
  Field yield(kPoints);
  for (Eigen::Index i = 0; i < strain.size(); ++i) {
    strain(i) = rng.uniform(-0.1, 0.1);
    plastic(i) = rng.uniform(-0.1, 0.1);
  }
  for (int p = 0; p < kPoints; ++p) yield(p) = rng.uniform(0.05, 0.25);
  for (const FlowForm form : {FlowForm::rate, FlowForm::rate_to_yield, FlowForm::literal, FlowForm::j2})
    for (const bool deviatoric : {false, true})
      for (const StrainNorm norm : {StrainNorm::frobenius, StrainNorm::voigt6}) {
        Plasticity law;
        law.form = form;
        law.deviatoric = deviatoric;
        law.norm = norm;
        law.creep_per_s = 20.0;
        law.max = 1.0;
        int count = 0;
        for (int p = 0; p < kPoints; ++p) {
          const int begin = p / 8 * 8;
          const unsigned found = find_flowing(strain.data(), plastic.data(), yield.data(), law, begin,
                                              std::min(begin + 8, kPoints));
          const Vec6 after = compute_plastic_strain(strain.col(p), plastic.col(p), {yield(p)}, law, 1e-3);
          const bool flows = after != plastic.col(p);
          EXPECT_EQ((found >> (p - begin)) & 1U, flows ? 1U : 0U) << p;
          count += flows ? 1 : 0;
        }
        EXPECT_GT(count, 5);
        EXPECT_LT(count, kPoints - 5);
      }
}

}  // namespace
}  // namespace argil::material
