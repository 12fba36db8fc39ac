#pragma once

#include "base/mandel.h"

namespace argil::solid {

using Mat34 = Eigen::Matrix<double, 3, 4>;    ///< one corner a column
using Mat12 = Eigen::Matrix<double, 12, 12>;  ///< corner by corner, x y z each

/// What the rest shape of a 4-node tet fixes for ever.
struct TetGeometry {
  Mat34 gradient = Mat34::Zero();  ///< ∇Nᵢ of eq. 1's shape functions [1/m]
  double volume = 0.0;             ///< [m³]
};

/// `rest` (3×4) [m]: corners, positive volume.
TetGeometry make_tet_geometry(const Mat34& rest);

/// F = Σ xᵢ ⊗ ∇Nᵢ. `deformed` (3×4) [m].
inline Mat3 compute_deformation_gradient(const Mat34& deformed, const Mat34& gradient) {
  return deformed * gradient.transpose();
}

/// The rotation nearest to F, det R = +1 also when F is inverted or flat.  F = R S with S symmetric.
/// Newton's iteration X ← ½(γX + (γX)⁻ᵀ) with the scaling of [Higham1986] where F is well conditioned and not
/// inverted, else the singular value decomposition with the smallest direction turned.
Mat3 compute_rotation(const Mat3& F);

/// Small strain in the turned frame: ε = sym(RᵀF) − 1 (Mandel). R = 1 gives the paper's Cauchy strain.
Vec6 compute_strain(const Mat3& F, const Mat3& R);

/// Isotropic stiffness in Mandel form [Pa].
Mat6 make_isotropic_stiffness(double lambda, double mu);

/// fᵢ = V R σ ∇Nᵢ with σ = C (ε − ε_p): the derivative of the elastic energy by the corners with R kept, [N].
Mat34 compute_element_force(const TetGeometry& tet, const Mat3& R, const Vec6& elastic_strain, const Mat6& C);

/// K = ∂f/∂x with R kept: blocks V R BᵢᵀC Bⱼ Rᵀ (12×12) [N/m]; symmetric, positive semi-definite.
Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat3& R, const Mat6& C);

}  // namespace argil::solid
