#pragma once

// How the stress of an isotropic law of large strain follows a change of motion, at one point or at eight
// side by side, in the principal directions of the elastic left stretch.

#include <array>

#include "base/lanes.h"
#include "base/mandel.h"
#include "base/types.h"
#include "solid/law.h"

namespace argil::solid {

/// 11 22 33 23 13 12 of a Mandel tensor, shears as they stand in the matrix.
inline std::array<double, 6> make_tensor(const Vec6& mandel) {
  constexpr double s = 1.0 / kSqrt2;
  return {mandel(0), mandel(1), mandel(2), s * mandel(3), s * mandel(4), s * mandel(5)};
}

/// How a change of Kirchhoff stress's work follows a change of motion, in the directions of b, with the
/// velocity gradient l = dF F⁻¹: dP Fᵀ has Σ normalᵢⱼ lⱼⱼ on its diagonal, and (w + τⱼ) lᵢⱼ + w lⱼᵢ at (i,
/// j).
template <class Real>
struct PrincipalTangent {
  Real normal[3];  ///< what is added to λ on the diagonal: the shear part of ∂τᵢ/∂ln λᵢ, less τᵢ
  Real own[3], next[3];  ///< w + τ_b and w + τ_a of the planes (a, b) = 23, 13, 12
  Real coupling[3];      ///< w = ½(bᵢ + bⱼ)(τᵢ − τⱼ)/(bᵢ − bⱼ) − ½(τᵢ + τⱼ)
  Real spent[3] = {};    ///< s: flow takes s sᵀ off the diagonal's 3×3

  void set_plane(int k, const Real& w, const Real& tau_a, const Real& tau_b) {
    coupling[k] = w;
    own[k] = w + tau_b;
    next[k] = w + tau_a;
  }
};

inline constexpr int kPlanes[3][2] = {{1, 2}, {0, 2}, {0, 1}};

/// Leaves out what is negative of each plane's 2×2, and stretches beyond which the diagonal would be. `mu`:
/// what moduli are about.
template <class Real>
ARGIL_INLINE void make_positive(const Real& mu, PrincipalTangent<Real>& tangent) {
  const Real zero = {};
  for (int i = 0; i < 3; ++i) tangent.normal[i] = tangent.normal[i] < zero ? zero : tangent.normal[i];
  for (int k = 0; k < 3; ++k) {
    const Real mean = 0.5 * (tangent.own[k] + tangent.next[k]);
    const Real half = 0.5 * (tangent.own[k] - tangent.next[k]);
    Real radius;
    set_root(radius, half * half + tangent.coupling[k] * tangent.coupling[k]);
    const Real largest = mean + radius;
    const Real kept = largest < zero ? zero : 0.5 * largest;
    const Real is_negative = mean < radius ? zero + 1.0 : zero;
    const Real over = radius > 1e-30 * mu ? 1.0 / radius : zero;
    tangent.own[k] = is_negative != 0.0 ? kept * (1.0 + half * over) : tangent.own[k];
    tangent.next[k] = is_negative != 0.0 ? kept * (1.0 - half * over) : tangent.next[k];
    tangent.coupling[k] = is_negative != 0.0 ? kept * (tangent.coupling[k] * over) : tangent.coupling[k];
  }
}

/// ∂P/∂F. directions: of b, in the world; inverse: F⁻¹ from these directions to the axes at rest; lambda:
/// what multiplies tr l on the diagonal [Pa].
Mat9 make_tangent(const PrincipalTangent<double>& tangent, double lambda, const Mat3& directions,
                  const Mat3& inverse);

}  // namespace argil::solid
