#include "eshelby_integral.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/mandel.h"

namespace argil::material {
namespace {

/// The Green operator Γ(n) of unit n as a Mandel matrix: with B_n: u ↦ sym(u ⊗ n) (6×3) and the acoustic
/// tensor B_nᵀ C B_n, it is B_n (B_nᵀ C B_n)⁻¹ B_nᵀ.
Mat6 compute_green_operator(const Mat6& C, const Vec3& n) {
  Eigen::Matrix<double, 6, 3> B;
  for (int k = 0; k < 3; ++k) {
    const Mat3 a = Vec3::Unit(k) * n.transpose();
    B.col(k) = to_mandel(0.5 * (a + a.transpose()));
  }
  const Mat3 acoustic = B.transpose() * C * B;
  return B * acoustic.inverse() * B.transpose();
}

Mat6 integrate(const Mat6& C, const Vec3& semi_axes, int num_heights, int num_turns) {
  const GaussRule rule = make_gauss_rule(num_heights);
  Mat6 sum = Mat6::Zero();
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double r = std::sqrt(1.0 - rule.node[i] * rule.node[i]);
    for (int k = 0; k < num_turns; ++k) {
      const double turn = 2.0 * std::numbers::pi * (k + 0.5) / num_turns;
      const Vec3 zeta(r * std::cos(turn), r * std::sin(turn), rule.node[i]);
      sum += rule.weight[i] * compute_green_operator(C, zeta.cwiseQuotient(semi_axes).normalized());
    }
  }
  return sum * C / (2.0 * num_turns);
}

}  // namespace

GaussRule make_gauss_rule(int num_points) {
  constexpr int kMaxNewton = 100;
  GaussRule rule;
  for (int i = 0; i < num_points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (num_points + 0.5));
    double slope = 1.0;
    for (int step = 0; step < kMaxNewton; ++step) {
      double before = 1.0, here = x;
      for (int k = 2; k <= num_points; ++k) {
        const double next = ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k;
        before = here;
        here = next;
      }
      slope = num_points * (x * here - before) / (x * x - 1.0);
      x -= here / slope;
      if (std::abs(here / slope) < 1e-16) break;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

EshelbyIntegral compute_eshelby_integral(const Mat6& C, const Vec3& semi_axes, double tolerance) {
  constexpr int kMostPoints = 2048;
  ARGIL_ASSERT((semi_axes.array() > 0.0).all(), semi_axes(0), semi_axes(1), semi_axes(2));
  int points[2] = {16, 8};  // heights, turns
  EshelbyIntegral result;
  result.tensor = integrate(C, semi_axes, points[0], points[1]);
  for (int& refined : points) {
    double difference = 1.0;
    while (difference > tolerance && refined < kMostPoints) {
      refined *= 2;
      const Mat6 finer = integrate(C, semi_axes, points[0], points[1]);
      difference = (finer - result.tensor).cwiseAbs().maxCoeff();
      result.tensor = finer;
    }
    result.difference = std::max(result.difference, difference);
  }
  result.num_directions = points[0] * points[1];
  return result;
}

}  // namespace argil::material
