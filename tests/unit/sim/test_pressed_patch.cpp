// How an elastic half-space resists under the forces that press on it. Expected: Hertz's patches, whose
// moments are known, and flat punches of their outline.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/pressed_patch.h"

namespace argil::sim {
namespace {

/// Hertz's pressure on an ellipse of these semi-axes, in a plane through `middle` that is turned by `turn`.
PressedMoments press_ellipse(double a, double b, const Vec3& middle, const Quat& turn) {
  constexpr int kPoints = 200;
  PressedMoments moments;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j) {
      const double x = (2.0 * i + 1.0) / kPoints - 1.0, y = (2.0 * j + 1.0) / kPoints - 1.0;
      const double inside = 1.0 - x * x - y * y;
      moments.add(middle + turn * Vec3(a * x, b * y, 0.0), inside > 0.0 ? std::sqrt(inside) : -1.0, 0.5);
    }
  return moments;
}

/// ∫ dθ / √(1 − e² sin² θ) from 0 to π/2.
double integrate_elliptic(double e) {
  constexpr int kParts = 10000;
  double sum = 0.0;
  for (int i = 0; i < kParts; ++i)
    sum += 1.0 / std::sqrt(1.0 - std::pow(e * std::sin((i + 0.5) * 0.5 * std::numbers::pi / kParts), 2));
  return sum * 0.5 * std::numbers::pi / kParts;
}

TEST(PressedPatch, OfABallIsHertzsDisc) {
  constexpr double kRadius = 3e-3, kModulus = 2e5;
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const PressedPatch patch = press_ellipse(kRadius, kRadius, Vec3(0.1, -0.2, 0.3), turn).find_patch();
  EXPECT_NEAR(patch.length / kRadius, 1.0, 1e-3);
  EXPECT_NEAR(patch.width / kRadius, 1.0, 1e-3);
  EXPECT_NEAR(patch.find_half_space_stiffness(kModulus, 0.0) / (2.0 * kModulus * kRadius), 1.0, 1e-3);
  EXPECT_NEAR(patch.springs, 0.5 * 0.25 * std::numbers::pi * 200 * 200, 200);
}

TEST(PressedPatch, OfALongToolIsAnEllipse) {
  constexpr double kLength = 6e-3, kWidth = 1.5e-3, kModulus = 2e5;
  const Quat turn(Eigen::AngleAxisd(2.0, Vec3(3, -2, 1).normalized()));
  const PressedPatch patch = press_ellipse(kLength, kWidth, Vec3(-4.0, 0.2, 0.3), turn).find_patch();
  EXPECT_NEAR(patch.length / kLength, 1.0, 1e-3);
  EXPECT_NEAR(patch.width / kWidth, 1.0, 1e-3);
  const double e = std::sqrt(1.0 - std::pow(kWidth / kLength, 2));
  EXPECT_NEAR(patch.find_half_space_stiffness(kModulus, 0.0) /
                  (std::numbers::pi * kModulus * kLength / integrate_elliptic(e)),
              1.0, 1e-3);
}

/// One node yields, a line of them does, and nothing does not press.
TEST(PressedPatch, OfFewNodesIsAPartOfACell) {
  constexpr double kCell = 4e-3, kModulus = 2e5;
  PressedMoments one;
  EXPECT_EQ(one.find_patch().find_half_space_stiffness(kModulus, kCell), 0.0);
  one.add(Vec3(0.1, 0.2, 0.3), -1.0, 5.0);
  EXPECT_EQ(one.find_patch().springs, 0.0);
  one.add(Vec3(0.1, 0.2, 0.3), 1.0, 5.0);
  const double alone = one.find_patch().find_half_space_stiffness(kModulus, kCell);
  EXPECT_GT(alone, 2.0 * kModulus * 0.2 * kCell);
  EXPECT_LT(alone, 2.0 * kModulus * 0.6 * kCell);
  one.add(Vec3(0.1, 0.204, 0.3), 1.0, 5.0);
  EXPECT_GT(one.find_patch().find_half_space_stiffness(kModulus, kCell), 1.2 * alone);
  EXPECT_GT(one.find_patch().find_half_space_stiffness(kModulus, 0.0), 0.0);
}

}  // namespace
}  // namespace argil::sim
