#pragma once

// Hencky's law at one point, or at eight side by side: F = Fₑ F_p with F = R S, plastic strain E_p = ½ ln
// F_pᵀF_p and the elastic left stretches of b = S exp(−2 E_p) S, which is R's frame of Fₑ Fₑᵀ. Tensors of six
// are 11 22 33 23 13 12, shears as they stand in the matrix.

#include <cmath>
#include <cstring>

#include "base/lanes.h"
#include "solid/polar_newton.h"
#include "solid/principal_tangent.h"

namespace argil::solid {

/// c = ½(ab + ba) of symmetric matrices: the product of those that have the same directions.
template <class Real>
ARGIL_INLINE void set_symmetric_product(const Real* a, const Real* b, Real* c) {
  c[0] = a[0] * b[0] + a[5] * b[5] + a[4] * b[4];
  c[1] = a[5] * b[5] + a[1] * b[1] + a[3] * b[3];
  c[2] = a[4] * b[4] + a[3] * b[3] + a[2] * b[2];
  c[3] = 0.5 * (a[5] * b[4] + a[1] * b[3] + a[3] * b[2] + (b[5] * a[4] + b[1] * a[3] + b[3] * a[2]));
  c[4] = 0.5 * (a[0] * b[4] + a[5] * b[3] + a[4] * b[2] + (b[0] * a[4] + b[5] * a[3] + b[4] * a[2]));
  c[5] = 0.5 * (a[0] * b[5] + a[5] * b[1] + a[4] * b[3] + (b[0] * a[5] + b[5] * a[1] + b[4] * a[3]));
}

/// exp(a) − 1, which keeps the digits of small a.
template <class Real>
ARGIL_INLINE void set_exponential(const Real* a, Real* result) {
  constexpr int kHalvings = 6;
  constexpr int kTerms = 10;
  Real small[6], product[6];
  for (int k = 0; k < 6; ++k) result[k] = small[k] = a[k] / static_cast<double>(1 << kHalvings);
  for (int term = kTerms; term > 1; --term) {  // a (1 + a/2 (1 + a/3 (…)))
    set_symmetric_product(small, result, product);
    for (int k = 0; k < 6; ++k) result[k] = small[k] + product[k] / static_cast<double>(term);
  }
  for (int i = 0; i < kHalvings; ++i) {
    set_symmetric_product(result, result, product);
    for (int k = 0; k < 6; ++k) result[k] = 2.0 * result[k] + product[k];
  }
}

ARGIL_INLINE void set_log1p(double& result, double x) {
  result = std::log1p(x);
}
/// ln(1 + x) for x > −1: 1 + x = 2ᵏ(1 + f) with f about 0, ln(1 + f) = 2 artanh(f/(2 + f)) by its series.
ARGIL_INLINE void set_log1p(Lanes& result, const Lanes& x) {
  using Bits = long long __attribute__((vector_size(sizeof(Lanes))));
  constexpr long long kOneBits = 0x3ff0000000000000, kMantissa = 0x000fffffffffffff;
  constexpr double kRootOf2 = 1.4142135623730951, kLogarithmOf2 = 0.69314718055994531;
  const Lanes one = Lanes{} + 1.0;
  const Lanes number = one + x;
  Bits bits;
  std::memcpy(&bits, &number, sizeof bits);
  const Bits reduced = (bits & kMantissa) | kOneBits;
  Lanes mantissa;
  std::memcpy(&mantissa, &reduced, sizeof mantissa);
  const Bits shift = (bits >> 52) - 1023;
  Lanes exponent = __builtin_convertvector(shift, Lanes);
  const Lanes is_high = mantissa > kRootOf2 ? one : Lanes{};
  mantissa = is_high != 0.0 ? 0.5 * mantissa : mantissa;
  exponent += is_high;
  const Lanes f = exponent == 0.0 ? x : mantissa - 1.0;
  const Lanes z = f / (2.0 + f);
  const Lanes squares = z * z;
  Lanes sum = {};
  for (int n = 23; n >= 1; n -= 2) sum = sum * squares + 1.0 / n;
  result = 2.0 * z * sum + kLogarithmOf2 * exponent;
}

/// One of Jacobi's rotations, in the plane of p and q: brings a_pq to zero. r: the third direction; a: 11 22
/// 33 23 13 12, N: the directions so far. Where `active` is 0 nothing changes.
template <int p, int q, class Real>
ARGIL_INLINE void rotate_plane(const Real& active, Real* a, Real33<Real>& N) {
  constexpr int r = 3 - p - q;
  constexpr int pq = 3 + r, rp = 3 + q, rq = 3 + p;
  const Real zero = {};
  const Real one = zero + 1.0;
  const Real half = 0.5 * (a[q] - a[p]);
  Real root;
  set_root(root, half * half + a[pq] * a[pq]);
  const Real divisor = half < 0.0 ? half - root : half + root;
  const Real can_turn = a[pq] * a[pq] * active != 0.0 ? one : zero;
  const Real tangent = can_turn != 0.0 ? a[pq] / (can_turn != 0.0 ? divisor : one) : zero;
  set_root(root, one + tangent * tangent);
  const Real cosine = one / root;
  const Real sine = tangent * cosine;
  const Real rise = sine / (one + cosine);
  const Real change = tangent * a[pq];
  a[p] -= change;
  a[q] += change;
  a[pq] = can_turn != 0.0 ? zero : a[pq];
  const Real of_p = a[rp], of_q = a[rq];
  a[rp] -= sine * (of_q + rise * of_p);
  a[rq] += sine * (of_p - rise * of_q);
  for (int k = 0; k < 3; ++k) {
    const Real x = N.m[3 * p + k], y = N.m[3 * q + k];
    N.m[3 * p + k] -= sine * (y + rise * x);
    N.m[3 * q + k] += sine * (x - rise * y);
  }
}

/// Eigenvalues (in a[0 … 2]) and vectors, the columns of N, of a symmetric matrix, which is lost.
template <class Real>
ARGIL_INLINE void find_modes(Real* a, Real33<Real>& N) {
  constexpr int kMostSweeps = 12;
  constexpr double kNothing = 1e-33;  // of the matrix's squares
  const Real zero = {};
  const Real one = zero + 1.0;
  for (int k = 0; k < 9; ++k) N.m[k] = zero + (k % 4 == 0 ? 1.0 : 0.0);
  const Real size = a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + 2.0 * (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    const Real rest = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
    const Real active = rest > kNothing * size ? one : zero;
    if (!any(active)) return;
    rotate_plane<0, 1>(active, a, N);
    rotate_plane<0, 2>(active, a, N);
    rotate_plane<1, 2>(active, a, N);
  }
}

/// Elastic stretches at a point, in the frame of R.
template <class Real>
struct ElasticStretch {
  Real excess[3];     ///< of b's eigenvalues over 1, which keeps the digits of small strains
  Real logarithm[3];  ///< εᵢ, half of b's: elastic strain
  Real33<Real> N;     ///< b's directions
  Real trace;         ///< Σ εᵢ
};

/// b − 1. `strain`: ε = S − 1. `plastic`: E_p.
template <class Real>
ARGIL_INLINE void set_left_excess(const Real* strain, const Real* plastic, Real* b) {
  Real squares[6];
  set_symmetric_product(strain, strain, squares);
  for (int k = 0; k < 6; ++k) b[k] = 2.0 * strain[k] + squares[k];
  // S (1 + D) S − 1 with D = exp(−2 E_p) − 1 has D + εD + Dε + εDε more; εDε = 2 {ε, {ε, D}} − {ε², D} of
  // {a, b} = ½(ab + ba).
  Real minus[6], D[6], product[6], inner[6], outer[6];
  for (int k = 0; k < 6; ++k) minus[k] = -2.0 * plastic[k];
  set_exponential(minus, D);
  set_symmetric_product(strain, D, product);
  set_symmetric_product(strain, product, inner);
  set_symmetric_product(squares, D, outer);
  for (int k = 0; k < 6; ++k) b[k] += D[k] + 2.0 * product[k] + (2.0 * inner[k] - outer[k]);
}

/// Modes of a symmetric matrix, and what the logarithm of 1 + it is in each.
template <class Real>
ARGIL_INLINE void find_logarithms(const Real* x, Real* excess, Real* logarithm, Real33<Real>& N) {
  Real a[6];
  for (int k = 0; k < 6; ++k) a[k] = x[k];
  find_modes(a, N);
  for (int i = 0; i < 3; ++i) {
    excess[i] = a[i];
    set_log1p(logarithm[i], a[i]);
  }
}

/// b − 1, or S − 1 where `plastic` is null: the logarithm of either follows once, for it is long.
template <class Real>
ARGIL_INLINE void set_excess(const Real* strain, const Real* plastic, Real* x) {
  if (plastic)
    set_left_excess(strain, plastic, x);
  else
    for (int k = 0; k < 6; ++k) x[k] = strain[k];
}

/// `strain`: ε = S − 1. `plastic`: E_p, or null where there is none.
template <class Real>
ARGIL_INLINE void find_elastic_stretch(const Real* strain, const Real* plastic,
                                       ElasticStretch<Real>& stretch) {
  Real x[6];
  set_excess(strain, plastic, x);
  find_logarithms(x, stretch.excess, stretch.logarithm, stretch.N);
  for (int i = 0; i < 3; ++i) {
    if (plastic)
      stretch.logarithm[i] = 0.5 * stretch.logarithm[i];
    else
      stretch.excess[i] = stretch.excess[i] * (2.0 + stretch.excess[i]);
  }
  stretch.trace = stretch.logarithm[0] + stretch.logarithm[1] + stretch.logarithm[2];
}

/// ½ ln(1 + x) of small x: artanh(z) by its series, z = x (2 + x)⁻¹.
template <class Real>
ARGIL_INLINE void set_small_logarithm(const Real* x, Real* result) {
  constexpr int kLast = 17;  // power of z
  const Real a = x[0] + 2.0, b = x[1] + 2.0, c = x[2] + 2.0;
  Real inverse[6] = {b * c - x[3] * x[3],    a * c - x[4] * x[4],    a * b - x[5] * x[5],
                     x[4] * x[5] - a * x[3], x[3] * x[5] - b * x[4], x[3] * x[4] - c * x[5]};
  const Real scale = 1.0 / (a * inverse[0] + x[5] * inverse[5] + x[4] * inverse[4]);
  Real z[6], squares[6], sum[6], product[6];
  for (int k = 0; k < 6; ++k) inverse[k] *= scale;
  set_symmetric_product(x, inverse, z);
  set_symmetric_product(z, z, squares);
  for (int k = 0; k < 6; ++k) sum[k] = Real{} + (k < 3 ? 1.0 / kLast : 0.0);
  for (int n = kLast - 2; n >= 1; n -= 2) {
    set_symmetric_product(squares, sum, product);
    for (int k = 0; k < 6; ++k) sum[k] = product[k];
    for (int k = 0; k < 3; ++k) sum[k] += 1.0 / n;
  }
  set_symmetric_product(z, sum, result);
}

/// ½ ln(1 + x).
template <class Real>
ARGIL_INLINE void set_half_logarithm(const Real* x, Real* result) {
  constexpr double kSmall = 0.2;  // ‖x‖ up to which the series ends within rounding
  const Real size = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + 2.0 * (x[3] * x[3] + x[4] * x[4] + x[5] * x[5]);
  const Real zero = {};
  const Real is_small = size < kSmall * kSmall ? zero + 1.0 : zero;
  const Real is_large = 1.0 - is_small;
  for (int k = 0; k < 6; ++k) result[k] = zero;
  if (any(is_small)) set_small_logarithm(x, result);
  if (!any(is_large)) return;
  Real excess[3], logarithm[3];
  Real33<Real> N;
  find_logarithms(x, excess, logarithm, N);
  constexpr int kRow[6] = {0, 1, 2, 1, 0, 0}, kColumn[6] = {0, 1, 2, 2, 2, 1};
  for (int k = 0; k < 6; ++k) {
    Real sum = zero;
    for (int i = 0; i < 3; ++i) sum += 0.5 * logarithm[i] * (N.m[3 * i + kRow[k]] * N.m[3 * i + kColumn[k]]);
    result[k] = is_large != 0.0 ? sum : result[k];
  }
}

/// ½ ln b, the elastic strain in the frame of R. `plastic`: null where there is none.
template <class Real>
ARGIL_INLINE void find_elastic_strain(const Real* strain, const Real* plastic, Real* elastic) {
  Real x[6];
  set_excess(strain, plastic, x);
  set_half_logarithm(x, elastic);
  if (plastic) return;
  for (int k = 0; k < 6; ++k) elastic[k] = 2.0 * elastic[k];  // ln S
}

/// w = μ ½(b_i + b_j)(ln b_i − ln b_j)/(b_i − b_j) − ½(τᵢ + τⱼ), which has no difference of nearly equal
/// numbers.
template <class Real>
ARGIL_INLINE void set_principal_tangent(const ElasticStretch<Real>& stretch, const Real& mu, const Real* tau,
                                        PrincipalTangent<Real>& tangent) {
  const Real zero = {};
  const Real one = zero + 1.0;
  for (int i = 0; i < 3; ++i) tangent.normal[i] = 2.0 * mu - tau[i];
  for (int k = 0; k < 3; ++k) {
    const int i = kPlanes[k][0], j = kPlanes[k][1];
    const Real at_j = one + stretch.excess[j];
    const Real y = (stretch.excess[i] - stretch.excess[j]) / at_j;
    Real logarithm;
    set_log1p(logarithm, y);
    const Real slope = y == 0.0 ? one : logarithm / (y == 0.0 ? one : y);
    const Real w = mu * (one + 0.5 * y) * slope - 0.5 * (tau[i] + tau[j]);
    tangent.set_plane(k, w, tau[i], tau[j]);
  }
}

}  // namespace argil::solid
