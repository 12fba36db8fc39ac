#pragma once

#include "base/types.h"

namespace argil {

inline constexpr double kSqrt2 = 1.4142135623730951;

/// Mandel vector (11 22 33 √2·23 √2·13 √2·12) of a symmetric 3×3 tensor; keeps inner products: a:b = aᵀb.
inline Vec6 to_mandel(const Mat3& a) {
  return (Vec6() << a(0, 0), a(1, 1), a(2, 2), kSqrt2 * a(1, 2), kSqrt2 * a(0, 2), kSqrt2 * a(0, 1))
      .finished();
}

/// Symmetric 3×3 tensor of a Mandel vector.
inline Mat3 from_mandel(const Vec6& a) {
  constexpr double s = 1.0 / kSqrt2;
  return (Mat3() << a(0), s * a(5), s * a(4), s * a(5), a(1), s * a(3), s * a(4), s * a(3), a(2)).finished();
}

}  // namespace argil
