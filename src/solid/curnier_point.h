#pragma once

// Curnier's law at one point, or at eight side by side: F = R S. With b = S⁴ − 1 its strain is E = ¼ S^(−3/2)
// b, and all that the stress wants is rational in S. Tensors of six are 11 22 33 23 13 12, shears as they
// stand in the matrix.

#include "base/lanes.h"
#include "solid/hencky_point.h"
#include "solid/principal_tangent.h"

namespace argil::solid {

/// (1 + x)⁴ − 1, which keeps the digits of small x.
template <class Real>
ARGIL_INLINE void set_fourth_excess(Real& result, const Real& x) {
  const Real square = x * (2.0 + x);
  result = square * (2.0 + square);
}
template <class Real>
ARGIL_INLINE void set_fourth_excess(const Real* x, Real* result) {
  Real squares[6], product[6];
  set_symmetric_product(x, x, squares);
  for (int k = 0; k < 6; ++k) squares[k] += 2.0 * x[k];
  set_symmetric_product(squares, squares, product);
  for (int k = 0; k < 6; ++k) result[k] = 2.0 * squares[k] + product[k];
}

/// What the law makes of the volume ratio J.
template <class Real>
struct CurnierVolume {
  Real stress;  ///< J θ θ′: Kirchhoff stress per λ
  Real slope;   ///< its derivative by ln J
  Real change;  ///< θ = ¼ (J^(5/2) − J^(−3/2))
  Real rise;    ///< J θ′
  Real bend;    ///< its derivative by ln J
};

/// `strain`: S − 1.
template <class Real>
ARGIL_INLINE void find_curnier_volume(const Real* x, CurnierVolume<Real>& volume) {
  const Real minors = x[1] * x[2] - x[3] * x[3] + (x[0] * x[2] - x[4] * x[4]) + (x[0] * x[1] - x[5] * x[5]);
  const Real determinant = x[0] * (x[1] * x[2] - x[3] * x[3]) - x[5] * (x[5] * x[2] - x[3] * x[4]) +
                           x[4] * (x[5] * x[3] - x[1] * x[4]);
  const Real excess = x[0] + x[1] + x[2] + minors + determinant;
  Real fourth, root;
  set_fourth_excess(fourth, excess);
  const Real J = 1.0 + excess;
  const Real over = 1.0 / (fourth + 1.0);  // J⁻⁴
  set_root(root, J);
  const Real small = root * J * J * over;  // J^(−3/2)
  volume.stress = J * fourth * (5.0 + 3.0 * over) / 32.0;
  volume.slope = J * (25.0 * (fourth + 1.0) - 2.0 + 9.0 * over) / 32.0;
  volume.change = 0.25 * small * fourth;
  volume.rise = small * (5.0 * (fourth + 1.0) + 3.0) / 8.0;
  volume.bend = small * (25.0 * (fourth + 1.0) - 9.0) / 16.0;
}

/// S⁻¹ of S = 1 + x.
template <class Real>
ARGIL_INLINE void set_inverse_tensor(const Real* x, Real* inverse) {
  const Real a = x[0] + 1.0, b = x[1] + 1.0, c = x[2] + 1.0;
  inverse[0] = b * c - x[3] * x[3];
  inverse[1] = a * c - x[4] * x[4];
  inverse[2] = a * b - x[5] * x[5];
  inverse[3] = x[4] * x[5] - a * x[3];
  inverse[4] = x[3] * x[5] - b * x[4];
  inverse[5] = x[3] * x[4] - c * x[5];
  const Real scale = 1.0 / (a * inverse[0] + x[5] * inverse[5] + x[4] * inverse[4]);
  for (int k = 0; k < 6; ++k) inverse[k] *= scale;
}

/// Biot stress RᵀP [Pa] of lambda, mu [Pa] and what more presses along ∂θ/∂F [Pa]. `strain`: S − 1.
template <class Real>
ARGIL_INLINE void set_curnier_stress(const Real* strain, const Real& lambda, const Real& mu,
                                     const Real& pressure, Real* stress) {
  CurnierVolume<Real> volume;
  find_curnier_volume(strain, volume);
  Real inverse[6], square[6], fourth[6], b[6], product[6];
  set_inverse_tensor(strain, inverse);
  set_symmetric_product(inverse, inverse, square);
  set_symmetric_product(square, square, fourth);
  set_fourth_excess(strain, b);
  set_symmetric_product(b, fourth, product);
  const Real spherical = lambda * volume.stress + pressure * volume.rise;
  for (int k = 0; k < 6; ++k)
    stress[k] = mu / 16.0 * (5.0 * b[k] + 3.0 * product[k]) + spherical * inverse[k];
}

/// μ E:E + ½ λ θ² [J/m³]. `strain`: S − 1.
template <class Real>
ARGIL_INLINE void set_curnier_energy(const Real* strain, const Real& lambda, const Real& mu, Real& energy) {
  CurnierVolume<Real> volume;
  find_curnier_volume(strain, volume);
  Real inverse[6], b[6], ratio[6], squares[6];
  set_inverse_tensor(strain, inverse);
  set_fourth_excess(strain, b);
  set_symmetric_product(b, inverse, ratio);
  set_symmetric_product(ratio, ratio, squares);
  const Real trace = squares[0] * inverse[0] + squares[1] * inverse[1] + squares[2] * inverse[2] +
                     2.0 * (squares[3] * inverse[3] + squares[4] * inverse[4] + squares[5] * inverse[5]);
  energy = mu / 16.0 * trace + 0.5 * lambda * volume.change * volume.change;
}

/// Principal directions N of S in the frame of R, and how stress follows motion in them; as much of it as
/// multiplies tr l is `trace` [Pa]. `strain`: S − 1.
template <class Real>
ARGIL_INLINE void find_curnier_tangent(const Real* strain, const Real& lambda, const Real& mu,
                                       const Real& pressure, Real33<Real>& N, Real& trace,
                                       PrincipalTangent<Real>& tangent) {
  CurnierVolume<Real> volume;
  find_curnier_volume(strain, volume);
  Real x[6], stretch[3], tau[3];
  for (int k = 0; k < 6; ++k) x[k] = strain[k];
  find_modes(x, N);
  const Real spherical = lambda * volume.stress + pressure * volume.rise;
  trace = lambda * volume.slope + pressure * volume.bend;
  for (int i = 0; i < 3; ++i) {
    Real fourth;
    set_fourth_excess(fourth, x[i]);
    const Real over = 1.0 / (fourth + 1.0);
    stretch[i] = 1.0 + x[i];
    tau[i] = mu / 16.0 * stretch[i] * fourth * (5.0 + 3.0 * over) + spherical;
    tangent.normal[i] = mu / 16.0 * stretch[i] * (25.0 * (fourth + 1.0) - 2.0 + 9.0 * over) - tau[i];
  }
  // τᵢ − τⱼ of shear over λᵢ − λⱼ is a polynomial, so nearly equal stretches lose no digits.
  for (int k = 0; k < 3; ++k) {
    const Real a = stretch[kPlanes[k][0]], b = stretch[kPlanes[k][1]];
    const Real aa = a * a, bb = b * b, ab = a * b;
    const Real quartic = aa * aa + bb * bb + ab * (aa + ab + bb);
    const Real ratio = mu / 16.0 * (5.0 * quartic - 2.0 + 3.0 * (aa + ab + bb) / (ab * ab * ab));
    const Real tau_a = tau[kPlanes[k][0]], tau_b = tau[kPlanes[k][1]];
    tangent.set_plane(k, 0.5 * (aa + bb) * ratio / (a + b) - 0.5 * (tau_a + tau_b), tau_a, tau_b);
  }
}

}  // namespace argil::solid
