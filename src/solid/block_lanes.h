#pragma once

#include "base/lanes.h"

namespace argil::solid {

/// A 3×3 block of a matrix, column by column.
struct Block {
  Lanes eight;
  double last;
};

ARGIL_INLINE void read_block(const double* from, Block& block) {
  read(from, block.eight);
  block.last = from[8];
}

ARGIL_INLINE void write_block(const Block& block, double* to) {
  write(block.eight, to);
  to[8] = block.last;
}

ARGIL_INLINE void transpose_block(Block& block) {
  block.eight = __builtin_shufflevector(block.eight, block.eight, 0, 3, 6, 1, 4, 7, 2, 5);
}

ARGIL_INLINE void add(const Block& a, Block& sum) {
  sum.eight += a.eight;
  sum.last += a.last;
}

ARGIL_INLINE void add(double scale, const Block& a, Block& sum) {
  sum.eight += scale * a.eight;
  sum.last += scale * a.last;
}

}  // namespace argil::solid
