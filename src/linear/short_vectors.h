#pragma once

#include "base/lanes.h"

// Vectors in floats with four numbers a row, the last of them 0; for functions before which
// ARGIL_EVERY_PROCESSOR stands. None is returned by value: how that is done depends on the processor.

namespace argil::linear {

using Floats4 = float __attribute__((vector_size(16)));
using Floats8 = float __attribute__((vector_size(32)));
// At any address. Pointers to them, for Clang forgets the alignment of what a function returns by reference.
using Floats4At __attribute__((aligned(4), may_alias)) = Floats4;
using Floats8At __attribute__((aligned(4), may_alias)) = Floats8;

ARGIL_INLINE Floats4At* four_at(float* at) {
  return reinterpret_cast<Floats4At*>(at);
}
ARGIL_INLINE const Floats4At* four_at(const float* at) {
  return reinterpret_cast<const Floats4At*>(at);
}
ARGIL_INLINE const Floats8At* eight_at(const float* at) {
  return reinterpret_cast<const Floats8At*>(at);
}

/// y = B x of a 3×3 block with columns of four.
ARGIL_INLINE void apply_block(const float* block, const Floats4& x, Floats4& y) {
  y = *four_at(block) * x[0] + *four_at(block + 4) * x[1] + *four_at(block + 8) * x[2];
}

/// Adds numbers of many rows up without losing any beside their sum.
ARGIL_INLINE void add_up(const Floats4& of_row, Quad& sum) {
  sum += __builtin_convertvector(of_row, Quad);
}
ARGIL_INLINE double add_lanes(const Quad& a) {
  return (a[0] + a[1]) + a[2];
}

}  // namespace argil::linear
