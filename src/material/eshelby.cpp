#include "material/eshelby.h"

#include <array>
#include <cmath>

#include "base/check.h"
#include "base/mandel.h"

namespace argil::material {
namespace {

/// Mura's integrals for semi-axes 1, 1, c, over 4π.
struct ShapeIntegrals {
  double i1;      // I₁/4π
  double i3;      // I₃/4π
  double i13;     // I₁₃/4π
  double c2_i13;  // c² I₁₃/4π
  double i11;     // I₁₁/4π = I₁₂/4π
  double c2_i33;  // c² I₃₃/4π
};

/// With s = 1/x² − 1 the integrals over s become c∫₀¹ x²(1+εx²)^{−1/2} dx and the like, ε = c² − 1: smooth at
/// ε = 0, where the closed forms are 0/0.
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
  ARGIL_ASSERT(c >= 0.0, c);
  constexpr double kNearSphere = 0.05;
  constexpr double kCylinder =
      1e9;  // ln(c)/c², by which a fibre differs from the cylinder, is below rounding
  ShapeIntegrals r{};
  if (c > kCylinder) return {0.5, 0.0, 0.0, 0.5, 0.25, 0.0};
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
  r.c2_i13 = c * c * r.i13;
  r.i11 = 0.25 * (1.0 - r.i13);
  r.c2_i33 = (1.0 - 2.0 * r.c2_i13) / 3.0;
  return r;
}

}  // namespace

Transverse compute_eshelby_transverse(double nu, double aspect) {
  const ShapeIntegrals s = compute_shape_integrals(aspect);
  const double a = 1.0 / (2.0 * (1.0 - nu));  // 4π/(8π(1−ν))
  const double b = (1.0 - 2.0 * nu) * a;
  const double P11 = 3.0 * a * s.i11 + b * s.i1;
  const double P12 = a * s.i11 - b * s.i1;
  const double P13 = a * s.c2_i13 - b * s.i1;
  const double P31 = a * s.i13 - b * s.i3;
  const double P33 = 3.0 * a * s.c2_i33 + b * s.i3;
  Transverse P;
  P.uu = (2.0 * (P11 + P12 + P13 + P31) + P33) / 3.0;
  P.uw = kSqrt2 * (2.0 * P13 - P11 - P12 + P33 - P31) / 3.0;
  P.wu = kSqrt2 * (2.0 * P31 - P11 - P12 + P33 - P13) / 3.0;
  P.ww = (P11 + P12 + 2.0 * (P33 - P13 - P31)) / 3.0;
  P.plane = P11 - P12;                                   // 2 P₁₂₁₂
  P.axial = a * (s.i13 + s.c2_i13) + b * (s.i1 + s.i3);  // 2 P₁₃₁₃
  return aspect == 1.0 ? to_transverse(average(P)) : P;  // no rounding between mean and deviator of a sphere
}

Mat6 compute_eshelby_tensor(double nu, double aspect) {
  return to_mandel_matrix(compute_eshelby_transverse(nu, aspect));
}

}  // namespace argil::material
