#include "linear/short_blocks.h"

#include "base/lanes.h"
#include "linear/vectors.h"

namespace argil::linear {
namespace {

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

/// Sums of one row: the first eight numbers of a block meet those of x at once, its last one alone.
struct RowSum {
  Floats8 eight = {};
  float last = 0.0F;
};

ARGIL_INLINE void add_block(const float* block, const float* x, RowSum& sum) {
  const Floats4 p = *four_at(x);
  sum.eight +=
      *reinterpret_cast<const Floats8At*>(block) * __builtin_shufflevector(p, p, 0, 0, 0, 1, 1, 1, 2, 2);
  sum.last += block[8] * p[2];
}

/// Row `row` of yₖ = A xₖ. Blocks of even and odd places apart: no sum waits for the one before it.
template <int Count>
ARGIL_INLINE void multiply_row(const BlockMatrix& pattern, const float* values,
                               const float* const (&x)[Count], std::ptrdiff_t row, Floats4 (&y)[Count]) {
  const int* column = pattern.column.data();
  int b = pattern.row_begin.data()[row];
  const int last = pattern.row_begin.data()[row + 1];
  const float* block = values + 9 * static_cast<std::ptrdiff_t>(b);
  RowSum even[Count], odd[Count];
  for (; b + 1 < last; b += 2, block += 18) {
    const std::ptrdiff_t at_even = 4 * static_cast<std::ptrdiff_t>(column[b]);
    const std::ptrdiff_t at_odd = 4 * static_cast<std::ptrdiff_t>(column[b + 1]);
    for (int k = 0; k < Count; ++k) add_block(block, x[k] + at_even, even[k]);
    for (int k = 0; k < Count; ++k) add_block(block + 9, x[k] + at_odd, odd[k]);
  }
  for (int k = 0; k < Count; ++k) {
    if (b < last) add_block(block, x[k] + 4 * static_cast<std::ptrdiff_t>(column[b]), even[k]);
    const Floats8 sum = even[k].eight + odd[k].eight;
    y[k] = Floats4{sum[0] + sum[3] + sum[6], sum[1] + sum[4] + sum[7],
                   sum[2] + sum[5] + (even[k].last + odd[k].last), 0.0F};
  }
}

/// Rows begin … end−1 of y = A x; returns x·y of them.
ARGIL_EVERY_PROCESSOR double multiply_rows(const BlockMatrix& pattern, const float* values, const float* x,
                                           std::ptrdiff_t begin, std::ptrdiff_t end, float* y) {
  Floats4 dot = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    Floats4 out[1];
    multiply_row<1>(pattern, values, {x}, row, out);
    *four_at(y + 4 * row) = out[0];
    dot += out[0] * *four_at(x + 4 * row);
  }
  return static_cast<double>(dot[0] + dot[1] + dot[2]);
}

ARGIL_EVERY_PROCESSOR void multiply_rows_by_several(const BlockMatrix& pattern, const float* values,
                                                    const float* const (&x)[ShortBlocks::kSeveral],
                                                    std::ptrdiff_t begin, std::ptrdiff_t end,
                                                    float* const (&y)[ShortBlocks::kSeveral]) {
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    Floats4 out[ShortBlocks::kSeveral];
    multiply_row<ShortBlocks::kSeveral>(pattern, values, x, row, out);
    for (int k = 0; k < ShortBlocks::kSeveral; ++k) *four_at(y[k] + 4 * row) = out[k];
  }
}

ARGIL_EVERY_PROCESSOR void advance_rows(const float* inverse, float alpha, float beta, const float* z,
                                        float* w, std::ptrdiff_t begin, std::ptrdiff_t end,
                                        const ShortBlocks::Iterate& at, ShortBlocks::Sums& sums) {
  const ShortBlocks::Iterate to = at;  // which stores below do not change
  Floats4 rr = {}, rz = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    const Floats4 p = *four_at(z + i) + beta * *four_at(to.p + i);
    const Floats4 q = *four_at(w + i) + beta * *four_at(to.q + i);
    const Floats4 r = *four_at(to.r + i) - alpha * q;
    *four_at(to.p + i) = p;
    *four_at(to.q + i) = q;
    *four_at(to.x + i) += alpha * p;
    *four_at(to.r + i) = r;
    const float* a = inverse + 3 * i;
    const Floats4 next = *four_at(a) * r[0] + *four_at(a + 4) * r[1] + *four_at(a + 8) * r[2];
    *four_at(w + i) = next;
    rr += r * r;
    rz += r * next;
  }
  sums = {static_cast<double>(rr[0] + rr[1] + rr[2]), static_cast<double>(rz[0] + rz[1] + rz[2])};
}

constexpr int kSeveral = ShortBlocks::kSeveral;

ARGIL_EVERY_PROCESSOR void compute_products_of_rows(const float* const (&x)[kSeveral],
                                                    const float* const (&y)[kSeveral], const float* r,
                                                    std::ptrdiff_t begin, std::ptrdiff_t end,
                                                    ShortBlocks::Products& products) {
  Floats4 xy[kSeveral][kSeveral] = {};
  Floats4 xr[kSeveral] = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4)
    for (int k = 0; k < kSeveral; ++k) {
      for (int j = k; j < kSeveral; ++j) xy[k][j] += *four_at(x[j] + i) * *four_at(y[k] + i);
      xr[k] += *four_at(x[k] + i) * *four_at(r + i);
    }
  const auto add = [](const Floats4& a) __attribute__((always_inline)) {
    return static_cast<double>(a[0] + a[1] + a[2]);
  };
  for (int k = 0; k < kSeveral; ++k) {
    for (int j = k; j < kSeveral; ++j) products.xy[k][j] = add(xy[k][j]);
    products.xr[k] = add(xr[k]);
  }
}

ARGIL_EVERY_PROCESSOR void combine_rows(const float (&a)[kSeveral], const float* const (&d)[kSeveral],
                                        const float* const (&y)[kSeveral], std::ptrdiff_t begin,
                                        std::ptrdiff_t end, float* x, float* r) {
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    Floats4 of_d = {}, of_y = {};
    for (int k = 0; k < kSeveral; ++k) {
      of_d += a[k] * *four_at(d[k] + i);
      of_y += a[k] * *four_at(y[k] + i);
    }
    *four_at(x + i) = of_d;
    *four_at(r + i) -= of_y;
  }
}

ARGIL_EVERY_PROCESSOR void shorten(const double* from, std::ptrdiff_t count, float* to) {
  for (std::ptrdiff_t i = 0; i < count; ++i) to[i] = static_cast<float>(from[i]);
}

}  // namespace

void ShortBlocks::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  const auto num_values = static_cast<std::size_t>(pattern.values.size());
  if (m_pattern == &pattern && m_revision.size() == num_rows && m_values.size() == num_values) return;
  m_pattern = &pattern;
  m_values.resize(num_values);
  m_inverse.assign(12 * num_rows, 0.0F);
  m_diagonal.resize(3, 3 * pattern.num_rows());
  m_revision.clear();
  for (const std::uint32_t revision : pattern.revision) m_revision.push_back(revision - 1);
}

void ShortBlocks::update(const BlockMatrix& matrix, Operator& whole, const OrderedRuns& runs) {
  prepare(matrix);
  const bool has_unstored = whole.has_unstored();
  runs.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      const auto diagonal = matrix.block(matrix.diagonal[row]);
      if (has_unstored) m_diagonal.middleCols<3>(3 * static_cast<Eigen::Index>(row)) = diagonal;
      if (m_revision[row] == matrix.revision[row]) continue;
      m_revision[row] = matrix.revision[row];
      const auto first = 9 * static_cast<std::ptrdiff_t>(matrix.row_begin[row]);
      const auto last = 9 * static_cast<std::ptrdiff_t>(matrix.row_begin[row + 1]);
      shorten(matrix.values.data() + first, last - first, m_values.data() + first);
      if (!has_unstored) set_inverse(static_cast<std::ptrdiff_t>(row), diagonal);
    }
  });
  if (!has_unstored) return;
  whole.add_unstored_diagonal(m_diagonal);
  runs.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) set_inverse(row, m_diagonal.middleCols<3>(3 * row));
  });
}

void ShortBlocks::set_inverse(std::ptrdiff_t row, const Mat3& block) {
  const Mat3 inverse = invert_block(block);
  for (int k = 0; k < 9; ++k)
    m_inverse.data()[12 * row + 4 * (k / 3) + k % 3] = static_cast<float>(inverse(k));
}

double ShortBlocks::multiply(std::ptrdiff_t begin, std::ptrdiff_t end, const float* x, float* y) const {
  return multiply_rows(*m_pattern, m_values.data(), x, begin, end, y);
}

void ShortBlocks::multiply_several(std::ptrdiff_t begin, std::ptrdiff_t end,
                                   const float* const (&x)[kSeveral], float* const (&y)[kSeveral]) const {
  multiply_rows_by_several(*m_pattern, m_values.data(), x, begin, end, y);
}

ShortBlocks::Products ShortBlocks::compute_products(std::ptrdiff_t begin, std::ptrdiff_t end,
                                                    const float* const (&x)[kSeveral],
                                                    const float* const (&y)[kSeveral], const float* r) {
  Products products;
  compute_products_of_rows(x, y, r, begin, end, products);
  return products;
}

void ShortBlocks::combine(std::ptrdiff_t begin, std::ptrdiff_t end, const float (&a)[kSeveral],
                          const float* const (&d)[kSeveral], const float* const (&y)[kSeveral], float* x,
                          float* r) {
  combine_rows(a, d, y, begin, end, x, r);
}

ShortBlocks::Sums ShortBlocks::advance(std::ptrdiff_t begin, std::ptrdiff_t end, float alpha, float beta,
                                       const float* z, float* w, const Iterate& to) const {
  Sums sums;
  advance_rows(m_inverse.data(), alpha, beta, z, w, begin, end, to, sums);
  return sums;
}

}  // namespace argil::linear
