// Curnier's law against its definition by powers of the principal stretches, and what it was chosen for:
// nominal stress that is linear to second order and has no bound.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "solid/law.h"

namespace argil::solid {
namespace {

constexpr StrainModel kCurnier = StrainModel::curnier;
const Elasticity kClay{3.0, 2.0};
const Vec6 kNone = Vec6::Zero();

/// (λᵐ − λ⁻ⁿ)/(m + n) with m = 5/2 and n = 3/2.
double find_strain(double stretch) {
  return (std::pow(stretch, 2.5) - std::pow(stretch, -1.5)) / 4.0;
}

double find_energy(const Vec3& stretches) {
  const double volume = find_strain(stretches.prod());
  double squares = 0.0;
  for (const double stretch : stretches) squares += find_strain(stretch) * find_strain(stretch);
  return kClay.mu * squares + 0.5 * kClay.lambda * volume * volume;
}

/// P₁₁ of a bar that is drawn with its sides held.
double find_nominal_stress(double stretch) {
  const Mat3 F = Vec3(stretch, 1.0, 1.0).asDiagonal();
  return compute_piola(kCurnier, make_motion(kCurnier, F), kNone, kClay)(0, 0);
}

TEST(Curnier, HasTheEnergyOfItsStrain) {
  Rng rng(6, "curnier");
  for (int i = 0; i < 20; ++i) {
    Mat3 F = Mat3::Identity();
    for (double& value : F.reshaped()) value += rng.uniform(-0.35, 0.35);
    if (!(F.determinant() > 0.05)) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> squares(F.transpose() * F);
    const double expected = find_energy(squares.eigenvalues().cwiseSqrt());
    EXPECT_NEAR(compute_energy_density(kCurnier, make_motion(kCurnier, F), kNone, kClay), expected,
                1e-10 * expected);
  }
}

TEST(Curnier, NominalStressIsLinearToSecondOrder) {
  // P(x) + P(−x) has no term in x²: it falls by 16 when x is halved.
  const auto even_part = [](double x) { return find_nominal_stress(1.0 + x) + find_nominal_stress(1.0 - x); };
  EXPECT_NEAR(even_part(0.04) / even_part(0.02), 16.0, 0.2);
  EXPECT_NEAR(find_nominal_stress(0.9), -0.1 * (kClay.lambda + 2.0 * kClay.mu),
              0.03 * 0.1 * (kClay.lambda + 2.0 * kClay.mu));
}

TEST(Curnier, StressHasNoBoundWhereATetWouldTurnInsideOut) {
  // P₁₁ = (λ + 2μ) (5λ₁⁴ − 2 − 3λ₁⁻⁴)/32.
  for (const double stretch : {0.5, 0.1, 0.01})
    EXPECT_NEAR(
        find_nominal_stress(stretch) / ((kClay.lambda + 2.0 * kClay.mu) / 32.0 *
                                        (5.0 * std::pow(stretch, 4) - 2.0 - 3.0 * std::pow(stretch, -4))),
        1.0, 1e-7)
        << stretch;
}

}  // namespace
}  // namespace argil::solid
