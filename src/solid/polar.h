#pragma once

#include "base/types.h"

namespace argil::solid {

/// The rotation nearest to F, det R = +1 also when F is inverted or flat.  F = R S with S symmetric.
/// Newton's iteration X ← ½(γX + (γX)⁻ᵀ) with the scaling of [Higham1986] where F is well conditioned and not
/// inverted, else the singular value decomposition with the smallest direction turned.
Mat3 compute_rotation(const Mat3& F);

/// Cofactor matrix: ∂ det a/∂a, and det(a) a⁻ᵀ where a is regular.
Mat3 compute_cofactor(const Mat3& a);

inline Mat3 compute_symmetric_part(const Mat3& a) {
  return 0.5 * (a + a.transpose());
}

/// [a]×: the matrix with [a]× b = a × b.
inline Mat3 make_cross_matrix(const Vec3& a) {
  return (Mat3() << 0.0, -a(2), a(1), a(2), 0.0, -a(0), -a(1), a(0), 0.0).finished();
}

/// The vector a with [a]× = M − Mᵀ.
inline Vec3 compute_axial(const Mat3& M) {
  return {M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1)};
}

}  // namespace argil::solid
