#pragma once

#include <vector>

#include "base/types.h"

namespace argil::material {

/// Eshelby's tensor P (6×6, Mandel; strain inside = P ε*) of an ellipsoid in a matrix of any anisotropy: the
/// slow reference for the closed forms of eshelby.h.
///   P = (1/4π) ∫ Γ(n) dω : C,  Γ_ijkl = sym(N_ik n_j n_l),  N⁻¹_ik = n_j C_ijkl n_l,  n ∥ (ζ₁/a₁, ζ₂/a₂,
///   ζ₃/a₃)
/// over the unit sphere ζ [Mura1987, eqs. 17.19–17.24]: Gauss's rule along axis 3, then the trapezoid rule
/// round it, each doubled until two results differ by no more than `tolerance` in every entry. `C` (Mandel)
/// [Pa]: positive definite.  `semi_axes` [m]: along 1, 2, 3; only their ratios matter.
struct EshelbyIntegral {
  Mat6 tensor = Mat6::Zero();
  double difference = 0.0;  ///< largest, between the last two refinements [–]
  int num_directions = 0;   ///< of the last one
};
EshelbyIntegral compute_eshelby_integral(const Mat6& C, const Vec3& semi_axes, double tolerance);

/// Nodes and weights of Gauss's rule on [−1, 1], by Newton's method on Legendre's polynomial.
struct GaussRule {
  std::vector<double> node;
  std::vector<double> weight;
};
GaussRule make_gauss_rule(int num_points);

}  // namespace argil::material
