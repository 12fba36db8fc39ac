#pragma once

#include "base/lanes.h"
#include "solid/polar.h"

namespace argil::solid {

template <class Real>
ARGIL_INLINE void add_squares(const Real33<Real>& a, Real& sum) {
  sum = a.m[0] * a.m[0] + a.m[1] * a.m[1] + a.m[2] * a.m[2];
  sum += a.m[3] * a.m[3] + a.m[4] * a.m[4] + a.m[5] * a.m[5];
  sum += a.m[6] * a.m[6] + a.m[7] * a.m[7] + a.m[8] * a.m[8];
}

/// Cofactors and determinant.
template <class Real>
ARGIL_INLINE void set_cofactor(const Real33<Real>& a, Real33<Real>& cofactor, Real& determinant) {
  for (int k = 0; k < 3; ++k) {
    const Real* p = a.m + 3 * ((k + 1) % 3);
    const Real* q = a.m + 3 * ((k + 2) % 3);
    cofactor.m[3 * k] = p[1] * q[2] - p[2] * q[1];
    cofactor.m[3 * k + 1] = p[2] * q[0] - p[0] * q[2];
    cofactor.m[3 * k + 2] = p[0] * q[1] - p[1] * q[0];
  }
  determinant = a.m[0] * cofactor.m[0] + a.m[1] * cofactor.m[1] + a.m[2] * cofactor.m[2];
}

/// Rotation of F = R S by X ← ½(γX + (γX)⁻ᵀ) with the scaling γ of [Higham1986], for one matrix or for eight.
/// `found` is false where F is inverted or nearly flat or the iteration does not end; R means nothing there.
template <class Real>
ARGIL_INLINE void iterate_rotation(const Real33<Real>& F, Real33<Real>& R, Real& found) {
  // Newton is quadratically convergent; from a condition number of 1e3 the scaled iteration needs at most 9
  // steps.
  constexpr int kMaxIterations = 12;
  constexpr double kSmallestRelativeDeterminant = 1e-8;
  // Once the iteration is near, a step leaves an eighth of the squared change: 5e-17 of this one.
  constexpr double kSquaredChange = 4e-16;
  const Real one = Real{} + 1.0;
  Real33<Real> inverse;  // transposed
  Real determinant, squares;
  set_cofactor(F, inverse, determinant);
  add_squares(F, squares);
  const Real zero = {};
  const Real cubes = squares * squares * squares;  // of the norm's square
  found = determinant * determinant > kSmallestRelativeDeterminant * kSmallestRelativeDeterminant * cubes
              ? one
              : zero;
  found = determinant > 0.0 ? found : zero;
  Real active = found;  // 1 or 0, as `found` is
  R = F;
  for (int iteration = 0; iteration < kMaxIterations && any(active); ++iteration) {
    set_cofactor(R, inverse, determinant);
    const Real scale = 1.0 / determinant;
    Real33<Real> difference;
    for (int k = 0; k < 9; ++k) {
      inverse.m[k] *= scale;
      difference.m[k] = R.m[k] - inverse.m[k];
    }
    Real change;
    add_squares(difference, change);
    const Real far = change >= 1e-2 ? active : zero;
    Real share = 0.5 * one;
    Real inverse_share = share;
    if (any(far)) {
      Real size, inverse_size, root;
      Real gamma = one;
      add_squares(R, size);
      add_squares(inverse, inverse_size);
      const Real ratio = inverse_size / size;
      set_root(root, ratio);
      set_root(gamma, root);
      gamma = far != 0.0 ? gamma : one;
      share = 0.5 * gamma;
      inverse_share = 0.5 / gamma;
    }
    for (int k = 0; k < 9; ++k) {
      const Real next = share * R.m[k] + inverse_share * inverse.m[k];
      R.m[k] = active != 0.0 ? next : R.m[k];
    }
    active = change >= kSquaredChange ? active : zero;
  }
  found = active != 0.0 ? zero : found;
}

inline void set_rotation_by_svd(const Real33<Lanes>& F, int lane, Real33<Lanes>& R) {
  Mat3 from;
  for (int k = 0; k < 9; ++k) from(k) = F.m[k][lane];
  const Mat3 rotation = compute_rotation(from);
  for (int k = 0; k < 9; ++k) R.m[k][lane] = rotation(k);
}

/// The same of every F: by its singular values where the iteration does not find it.
ARGIL_INLINE void find_rotation(const Real33<Lanes>& F, Real33<Lanes>& R) {
  Lanes found;
  iterate_rotation(F, R, found);
  for (int lane = 0; lane < kLanes; ++lane)
    if (found[lane] == 0.0) set_rotation_by_svd(F, lane, R);
}

}  // namespace argil::solid
