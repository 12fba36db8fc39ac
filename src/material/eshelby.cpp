#include "material/eshelby.h"

#include <array>
#include <cmath>
#include <numbers>

namespace argil::material {
namespace {

/// Mura's integrals for semi-axes 1, 1, c, over 4π, those with index 3 twice times c² where P needs them so.
struct ShapeIntegrals {
  double i1;      // I₁/4π
  double i3;      // I₃/4π
  double i13;     // I₁₃/4π
  double i11;     // I₁₁/4π = I₁₂/4π
  double c2_i33;  // c² I₃₃/4π
};

/// With s = 1/x² − 1 the integrals become c∫₀¹ x²(1+εx²)^{−1/2} dx and the like, ε = c² − 1: smooth near ε =
/// 0.
void integrate_near_sphere(double c, ShapeIntegrals& result) {
  // Gauss–Legendre, 8 points on [−1, 1]
  constexpr std::array<double, 4> node = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                          0.96028985649753623};
  constexpr std::array<double, 4> weight = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                            0.10122853629037626};
  const double e = c * c - 1.0;
  result.i1 = result.i3 = result.i13 = 0.0;
  for (std::size_t k = 0; k < 4; ++k)
    for (const double sign : {-1.0, 1.0}) {
      const double x = 0.5 * (1.0 + sign * node[k]);
      const double w = 0.5 * c * weight[k];
      const double root = std::sqrt(1.0 + e * x * x);
      result.i1 += w * x * x / root;
      result.i3 += w * x * x / (root * root * root);
      result.i13 += w * x * x * x * x / (root * root * root);
    }
}

ShapeIntegrals compute_shape_integrals(double c) {
  ShapeIntegrals r{};
  constexpr double kNearSphere = 0.05;
  if (std::abs(c - 1.0) < kNearSphere) {
    integrate_near_sphere(c, r);
  } else {
    if (c < 1.0) {
      const double q = 1.0 - c * c;
      r.i1 = 0.5 * c / (q * std::sqrt(q)) * (std::acos(c) - c * std::sqrt(q));
    } else {
      const double q = c * c - 1.0;
      r.i1 = 0.5 * c / (q * std::sqrt(q)) * (c * std::sqrt(q) - std::acosh(c));
    }
    r.i3 = 1.0 - 2.0 * r.i1;
    r.i13 = (r.i1 - r.i3) / (c * c - 1.0);
  }
  r.i11 = 0.25 * (1.0 - r.i13);
  r.c2_i33 = (1.0 - 2.0 * c * c * r.i13) / 3.0;
  return r;
}

}  // namespace

Mat6 compute_eshelby_tensor(double nu, double aspect) {
  const ShapeIntegrals s = compute_shape_integrals(aspect);
  const double c2 = aspect * aspect;
  const double a = 1.0 / (2.0 * (1.0 - nu));  // 4π/(8π(1−ν))
  const double b = (1.0 - 2.0 * nu) * a;
  Mat6 P = Mat6::Zero();
  P(0, 0) = P(1, 1) = 3.0 * a * s.i11 + b * s.i1;
  P(2, 2) = 3.0 * a * s.c2_i33 + b * s.i3;
  P(0, 1) = P(1, 0) = a * s.i11 - b * s.i1;
  P(0, 2) = P(1, 2) = a * c2 * s.i13 - b * s.i1;
  P(2, 0) = P(2, 1) = a * s.i13 - b * s.i3;
  // Shear entries 2·P₂₃₂₃ and so on: Mandel.
  P(3, 3) = P(4, 4) = a * (1.0 + c2) * s.i13 + b * (s.i1 + s.i3);
  P(5, 5) = 2.0 * a * s.i11 + 2.0 * b * s.i1;
  return P;
}

}  // namespace argil::material
