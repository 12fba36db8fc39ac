// Rows of the matrix, gathered from the tets around their nodes.

#include <algorithm>

#include "solid/block_lanes.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// The gradients of a tet add up to nothing, and so do the blocks of a row.
ARGIL_INLINE void set_diagonal(Block* sum, int diagonal, int num_blocks) {
  Block others = {};
  for (int k = 0; k <= num_blocks; ++k)
    if (k != diagonal) add(sum[k], others);
  sum[diagonal].eight = -others.eight;
  sum[diagonal].last = -others.last;
}

ARGIL_INLINE void write_row(const Block* sum, int num_blocks, double* out) {
  for (int k = 0; k < num_blocks; ++k) write_block(sum[k], out + 9 * k);
}

/// Asks for what the row of one corner is gathered from, which lies here and there.
ARGIL_INLINE void prefetch_corner(const RowArrays& rows, int corner) {
  const std::ptrdiff_t tet = corner / 4;
  __builtin_prefetch(rows.turned_gradient + 12 * tet);
  __builtin_prefetch(rows.turned_gradient + 12 * tet + 8);
  __builtin_prefetch(rows.block_of_pair + 4 * static_cast<std::ptrdiff_t>(corner));
  __builtin_prefetch(rows.weight + tet);
  __builtin_prefetch(rows.lambda + tet);
  __builtin_prefetch(rows.mu + tet);
}

template <int N, int Longest>
ARGIL_INLINE void gather_pairs(const PairArrays& rows, int begin, int end, int first_block, int num_blocks) {
  constexpr std::ptrdiff_t kPairs = N * (N - 1) / 2;
  Block sum[Longest + 1];  // the last one is of nodes without a row
  std::fill(sum, sum + num_blocks + 1, Block{});
  int diagonal = 0;
  for (int c = begin; c < end; ++c) {
    const int corner = rows.corners[c];
    const int i = corner % N;
    const double* of_tet = rows.pairs + 9 * kPairs * (corner / N);
    const int* blocks = rows.block_of_pair + N * static_cast<std::ptrdiff_t>(corner);
    diagonal = blocks[i] - first_block;
    for (int j = 0; j < N; ++j) {
      if (j == i) continue;
      Block pair;
      read_block(of_tet + 9 * find_pair<N>(i, j), pair);
      if (j < i) transpose_block(pair);
      add(pair, sum[blocks[j] < 0 ? num_blocks : blocks[j] - first_block]);
    }
  }
  set_diagonal(sum, diagonal, num_blocks);
  write_row(sum, num_blocks, rows.values + 9 * static_cast<std::ptrdiff_t>(first_block));
}

}  // namespace

ARGIL_EVERY_PROCESSOR void set_isotropic_row(const RowArrays& rows, int begin, int end, int first_block,
                                             int num_blocks) {
  Block sum[kLongestRow + 1];  // the last one is of nodes without a row
  std::fill(sum, sum + num_blocks + 1, Block{});
  constexpr int kAhead = 5;
  int diagonal = 0;
  for (int c = begin; c < end; ++c) {
    prefetch_corner(rows, rows.corners[std::min(c + kAhead, end - 1)]);
    const int corner = rows.corners[c];
    const int i = corner % 4;
    const std::ptrdiff_t tet = corner / 4;
    const double* gradient = rows.turned_gradient + 12 * tet;
    const double* own = gradient + 3 * i;
    const Quad ci = {own[0], own[1], own[2], 0.0};
    const double weight = rows.scale * rows.weight[tet];
    const Quad li = weight * rows.lambda[tet] * ci;
    const Quad mi = weight * rows.mu[tet] * ci;
    const Lanes li_rows = __builtin_shufflevector(li, li, 0, 1, 2, 0, 1, 2, 0, 1);
    const Lanes mi_columns = __builtin_shufflevector(mi, mi, 0, 0, 0, 1, 1, 1, 2, 2);
    const double last = li[2] + mi[2];
    const int* blocks = rows.block_of_pair + 4 * static_cast<std::ptrdiff_t>(corner);
    diagonal = blocks[i] - first_block;
    for (int j = 0; j < 4; ++j) {
      if (j == i) continue;
      const double* other = gradient + 3 * j;
      const Quad cj = {other[0], other[1], other[2], 0.0};
      const Quad product = mi * cj;
      const double dot = product[0] + product[1] + product[2];
      const Lanes cj_rows = __builtin_shufflevector(cj, cj, 0, 1, 2, 0, 1, 2, 0, 1);
      const Lanes cj_columns = __builtin_shufflevector(cj, cj, 0, 0, 0, 1, 1, 1, 2, 2);
      Block& block = sum[blocks[j] < 0 ? num_blocks : blocks[j] - first_block];
      block.eight +=
          li_rows * cj_columns + cj_rows * mi_columns + Lanes{dot, 0.0, 0.0, 0.0, dot, 0.0, 0.0, 0.0};
      block.last += last * cj[2] + dot;
    }
  }
  set_diagonal(sum, diagonal, num_blocks);
  write_row(sum, num_blocks, rows.values + 9 * static_cast<std::ptrdiff_t>(first_block));
}

ARGIL_EVERY_PROCESSOR void set_row_of_pairs(const PairArrays& rows, int begin, int end, int first_block,
                                            int num_blocks) {
  gather_pairs<4, kLongestRow>(rows, begin, end, first_block, num_blocks);
}

ARGIL_EVERY_PROCESSOR void set_row_of_quadratic_pairs(const PairArrays& rows, int begin, int end,
                                                      int first_block, int num_blocks) {
  gather_pairs<10, kLongestQuadraticRow>(rows, begin, end, first_block, num_blocks);
}

ARGIL_EVERY_PROCESSOR void sum_corner_forces(const double* corner_force, const int* corners, int begin,
                                             int end, double* force) {
  Quad even = {}, odd = {}, of_corner;  // even and odd apart, so that no sum waits for the one before it
  int c = begin;
  for (; c + 1 < end; c += 2) {
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c]), of_corner);
    even += of_corner;
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c + 1]), of_corner);
    odd += of_corner;
  }
  if (c < end) {
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c]), of_corner);
    even += of_corner;
  }
  even += odd;
  for (int k = 0; k < 3; ++k) force[k] = even[k];
}

}  // namespace argil::solid
