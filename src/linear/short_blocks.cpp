#include "linear/short_blocks.h"

#include "base/lanes.h"
#include "linear/vectors.h"

namespace argil::linear {
namespace {

using Floats4 = float __attribute__((vector_size(16)));
using Floats8 = float __attribute__((vector_size(32)));
using Floats4At = float __attribute__((vector_size(16), aligned(4), may_alias));
using Floats8At = float __attribute__((vector_size(32), aligned(4), may_alias));

/// Sums of one row: the first eight numbers of a block meet those of x at once, its last one alone.
struct RowSum {
  Floats8 eight = {};
  float last = 0.0F;
};

ARGIL_INLINE void add_block(const float* block, const float* x, RowSum& sum) {
  const Floats4 p = *reinterpret_cast<const Floats4At*>(x);
  sum.eight +=
      *reinterpret_cast<const Floats8At*>(block) * __builtin_shufflevector(p, p, 0, 0, 0, 1, 1, 1, 2, 2);
  sum.last += block[8] * p[2];
}

/// Rows begin … end−1 of y = A x with four numbers a row in x. Blocks of even and odd places apart: no sum
/// waits for the one before it.
ARGIL_EVERY_PROCESSOR void multiply_rows(const BlockMatrix& pattern, const float* values, const float* x,
                                         std::ptrdiff_t begin, std::ptrdiff_t end, double* y) {
  const int* column = pattern.column.data();
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    int b = pattern.row_begin.data()[row];
    const int last = pattern.row_begin.data()[row + 1];
    const float* block = values + 9 * static_cast<std::ptrdiff_t>(b);
    RowSum even, odd;
    for (; b + 1 < last; b += 2, block += 18) {
      add_block(block, x + 4 * static_cast<std::ptrdiff_t>(column[b]), even);
      add_block(block + 9, x + 4 * static_cast<std::ptrdiff_t>(column[b + 1]), odd);
    }
    if (b < last) add_block(block, x + 4 * static_cast<std::ptrdiff_t>(column[b]), even);
    const Floats8 sum = even.eight + odd.eight;
    y[3 * row] = static_cast<double>(sum[0] + sum[3] + sum[6]);
    y[3 * row + 1] = static_cast<double>(sum[1] + sum[4] + sum[7]);
    y[3 * row + 2] = static_cast<double>(sum[2] + sum[5] + (even.last + odd.last));
  }
}

ARGIL_EVERY_PROCESSOR void shorten(const double* from, std::ptrdiff_t count, float* to) {
  for (std::ptrdiff_t i = 0; i < count; ++i) to[i] = static_cast<float>(from[i]);
}

}  // namespace

void ShortBlocks::update(const BlockMatrix& matrix, const OrderedRuns& rows) {
  m_values.resize(static_cast<std::size_t>(matrix.values.size()));
  m_x.resize(static_cast<std::size_t>(4 * matrix.num_rows()));
  rows.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const auto first = 9 * static_cast<std::ptrdiff_t>(matrix.row_begin[static_cast<std::size_t>(begin)]);
    const auto last = 9 * static_cast<std::ptrdiff_t>(matrix.row_begin[static_cast<std::size_t>(end)]);
    shorten(matrix.values.data() + first, last - first, m_values.data() + first);
  });
}

double ShortBlocks::multiply(const BlockMatrix& pattern, const Points& x, Points& y, OrderedRuns& rows) {
  const std::ptrdiff_t num_rows = pattern.num_rows();
  rows.each(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k)
        m_x.data()[4 * row + k] = static_cast<float>(x.data()[3 * row + k]);
  });
  return rows.sum(num_rows, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    multiply_rows(pattern, m_values.data(), m_x.data(), begin, end, y.data());
    return compute_dot(x.data(), y.data(), begin, end);
  });
}

}  // namespace argil::linear
