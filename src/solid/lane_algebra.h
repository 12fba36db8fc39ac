#pragma once

#include "base/lanes.h"

namespace argil::solid {

// Products of 3×3 matrices, eight side by side. Tensors of six are 11 22 33 23 13 12.

/// c = ab.
ARGIL_INLINE void multiply(const Real33<Lanes>& a, const Real33<Lanes>& b, Real33<Lanes>& c) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      c.m[3 * column + row] = a.m[row] * b.m[3 * column] + a.m[3 + row] * b.m[3 * column + 1] +
                              a.m[6 + row] * b.m[3 * column + 2];
}

/// c = abᵀ.
ARGIL_INLINE void multiply_transposed(const Real33<Lanes>& a, const Real33<Lanes>& b, Real33<Lanes>& c) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      c.m[3 * column + row] =
          a.m[row] * b.m[column] + a.m[3 + row] * b.m[3 + column] + a.m[6 + row] * b.m[6 + column];
}

/// a v of four columns v.
ARGIL_INLINE void turn(const Real33<Lanes>& a, const Lanes* v, Lanes* turned) {
  for (int i = 0; i < 4; ++i) {
    const Lanes* u = v + 3 * i;
    for (int k = 0; k < 3; ++k) turned[3 * i + k] = a.m[k] * u[0] + a.m[3 + k] * u[1] + a.m[6 + k] * u[2];
  }
}

/// aᵀ v of four columns v.
ARGIL_INLINE void turn_back(const Real33<Lanes>& a, const Lanes* v, Lanes* turned) {
  for (int i = 0; i < 4; ++i) {
    const Lanes* u = v + 3 * i;
    for (int k = 0; k < 3; ++k)
      turned[3 * i + k] = a.m[3 * k] * u[0] + a.m[3 * k + 1] * u[1] + a.m[3 * k + 2] * u[2];
  }
}

/// sym(RᵀH).
ARGIL_INLINE void set_turned_tensor(const Real33<Lanes>& R, const Real33<Lanes>& H, Lanes* tensor) {
  Lanes S[9];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      S[3 * i + j] =
          R.m[3 * i] * H.m[3 * j] + R.m[3 * i + 1] * H.m[3 * j + 1] + R.m[3 * i + 2] * H.m[3 * j + 2];
  for (int k = 0; k < 3; ++k) tensor[k] = S[4 * k];
  tensor[3] = 0.5 * (S[5] + S[7]);
  tensor[4] = 0.5 * (S[2] + S[6]);
  tensor[5] = 0.5 * (S[1] + S[3]);
}

/// The symmetric matrix of a tensor.
ARGIL_INLINE void set_symmetric(const Lanes* t, Real33<Lanes>& a) {
  a = {{t[0], t[5], t[4], t[5], t[1], t[3], t[4], t[3], t[2]}};
}

}  // namespace argil::solid
