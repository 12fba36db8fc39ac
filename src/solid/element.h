#pragma once

#include "solid/law.h"
#include "solid/polar.h"

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

/// fᵢ = V P ∇Nᵢ = ∂W/∂xᵢ [N].
Mat34 compute_element_force(const TetGeometry& tet, StrainModel model, const PointMotion& motion,
                            const Vec6& plastic_strain, const Elasticity& e);

/// K with the rotation kept: blocks V R BᵢᵀC Bⱼ Rᵀ (12×12) [N/m]; symmetric, positive semi-definite. The
/// one-step matrix of the linear and corotational models.
Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat3& R, const Mat6& C);

/// K from ∂P/∂F: blocks V ∇Nᵢ·A·∇Nⱼ (12×12) [N/m].
Mat12 compute_element_stiffness(const TetGeometry& tet, const Mat9& tangent);

/// Block g_iᵀ A g_j of a tangent: (r, s) = Σ_cd g_i(c) A(3c+r, 3d+s) g_j(d).
Mat3 compute_tangent_block(const Vec3& g_i, const Mat9& A, const Vec3& g_j);

}  // namespace argil::solid
