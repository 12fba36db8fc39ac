#include "preconditioners/short_ssor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "linear/short_vectors.h"

namespace argil::bench {

/// The rows of a kind of blocks, as sweeps see them.
struct BlockRows {
  const int* begin;
  const int* column;
  const float* values;
};

struct SsorArrays {
  BlockRows upper, other, lower;
  const float* unscale;
  float *r, *p, *t, *s, *x;
};

namespace {

using linear::Floats4;
using linear::Floats8;
using linear::four_at;

/// Eight numbers of a block at once, its last one alone.
struct RowSum {
  Floats8 eight = {};
  float last = 0.0F;
};

ARGIL_INLINE void add_block(const float* block, const float* x, RowSum& sum) {
  const Floats4 p = *four_at(x);
  sum.eight += *linear::eight_at(block) * __builtin_shufflevector(p, p, 0, 0, 0, 1, 1, 1, 2, 2);
  sum.last += block[8] * p[2];
}

ARGIL_INLINE void add_blocks(const BlockRows& blocks, std::ptrdiff_t begin, std::ptrdiff_t end,
                             const float* x, RowSum& even, RowSum& odd) {
  std::ptrdiff_t b = begin;
  const float* block = blocks.values + 9 * b;
  for (; b + 1 < end; b += 2, block += 18) {
    add_block(block, x + 4 * static_cast<std::ptrdiff_t>(blocks.column[b]), even);
    add_block(block + 9, x + 4 * static_cast<std::ptrdiff_t>(blocks.column[b + 1]), odd);
  }
  if (b < end) add_block(block, x + 4 * static_cast<std::ptrdiff_t>(blocks.column[b]), even);
}

ARGIL_INLINE Floats4 add_up(const RowSum& even, const RowSum& odd) {
  const Floats8 sum = even.eight + odd.eight;
  return Floats4{sum[0] + sum[3] + sum[6], sum[1] + sum[4] + sum[7], sum[2] + sum[5] + (even.last + odd.last),
                 0.0F};
}

/// `known` + the row of `blocks` times x + what the sums hold. The last block meets what was found just
/// before, and goes column by column, which is the shortest way from there to here.
ARGIL_INLINE Floats4 finish_row(const BlockRows& blocks, std::ptrdiff_t row, const float* x,
                                const Floats4& known, RowSum& even, RowSum& odd) {
  const std::ptrdiff_t begin = blocks.begin[row];
  const std::ptrdiff_t last = blocks.begin[row + 1] - 1;
  if (last < begin) return known + add_up(even, odd);
  add_blocks(blocks, begin, last, x, even, odd);
  const Floats4 sum = known + add_up(even, odd);
  const float* block = blocks.values + 9 * last;
  const Floats4 p = *four_at(x + 4 * static_cast<std::ptrdiff_t>(blocks.column[last]));
  const Floats4 zero = {};
  const Floats4 a = __builtin_shufflevector(*four_at(block), zero, 0, 1, 2, 4);
  const Floats4 b = __builtin_shufflevector(*four_at(block + 3), zero, 0, 1, 2, 4);
  const Floats4 c = __builtin_shufflevector(*four_at(block + 6), zero, 0, 1, 2, 4);
  return (sum + a * p[0]) + (b * p[1] + c * p[2]);
}

ARGIL_INLINE double add_lanes(const Floats4& a) {
  return static_cast<double>(a[0] + a[1] + a[2]);
}

/// a times b, or aᵀ times b, of 3 columns of four.
ARGIL_INLINE Floats4 multiply(const float* a, const Floats4& b) {
  return *four_at(a) * b[0] + *four_at(a + 4) * b[1] + *four_at(a + 8) * b[2];
}
ARGIL_INLINE Floats4 multiply_transposed(const float* a, const Floats4& b) {
  const Floats4 x = *four_at(a) * b, y = *four_at(a + 4) * b, z = *four_at(a + 8) * b;
  return Floats4{x[0] + x[1] + x[2], y[0] + y[1] + y[2], z[0] + z[1] + z[2], 0.0F};
}

// Rows begin … end−1, which are a group:

/// p = r + β p, t = (1+L)⁻ᵀ p.
ARGIL_EVERY_PROCESSOR void sweep_back(const SsorArrays& a, float beta, std::ptrdiff_t begin,
                                      std::ptrdiff_t end) {
  for (std::ptrdiff_t row = end - 1; row >= begin; --row) {
    RowSum even, odd;
    const Floats4 p = *four_at(a.r + 4 * row) + beta * *four_at(a.p + 4 * row);
    *four_at(a.p + 4 * row) = p;
    *four_at(a.t + 4 * row) = finish_row(a.upper, row, a.t, p, even, odd);
  }
}

/// s = (1+L)⁻¹ (p − t + R t); returns p·(t + s).
ARGIL_EVERY_PROCESSOR double sweep_forth(const SsorArrays& a, std::ptrdiff_t begin, std::ptrdiff_t end) {
  Floats4 dot = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    RowSum even, odd;
    add_blocks(a.other, a.other.begin[row], a.other.begin[row + 1], a.t, even, odd);
    const Floats4 p = *four_at(a.p + 4 * row);
    const Floats4 t = *four_at(a.t + 4 * row);
    const Floats4 s = finish_row(a.lower, row, a.s, p - t, even, odd);
    *four_at(a.s + 4 * row) = s;
    dot += p * (t + s);
  }
  return add_lanes(dot);
}

/// x += α t, r −= α (t + s); returns r·r.
ARGIL_EVERY_PROCESSOR double advance(const SsorArrays& a, float alpha, std::ptrdiff_t begin,
                                     std::ptrdiff_t end) {
  Floats4 rr = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    const Floats4 t = *four_at(a.t + i);
    const Floats4 r = *four_at(a.r + i) - alpha * (t + *four_at(a.s + i));
    *four_at(a.x + i) += alpha * t;
    *four_at(a.r + i) = r;
    rr += r * r;
  }
  return add_lanes(rr);
}

/// r = (1+L)⁻¹ r; returns r·r.
ARGIL_EVERY_PROCESSOR double substitute(const SsorArrays& a, std::ptrdiff_t begin, std::ptrdiff_t end) {
  Floats4 rr = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    RowSum even, odd;
    const Floats4 r = finish_row(a.lower, row, a.r, *four_at(a.r + 4 * row), even, odd);
    *four_at(a.r + 4 * row) = r;
    rr += r * r;
  }
  return add_lanes(rr);
}

/// ‖C (1+L) r‖², which is that of b − A x.
ARGIL_EVERY_PROCESSOR double compute_residual(const SsorArrays& a, std::ptrdiff_t begin, std::ptrdiff_t end) {
  Floats4 squares = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    RowSum even, odd;
    add_blocks(a.lower, a.lower.begin[row], a.lower.begin[row + 1], a.r, even, odd);
    const Floats4 r = *four_at(a.r + 4 * row) - add_up(even, odd);
    const Floats4 unscaled = multiply(a.unscale + 12 * row, r);
    squares += unscaled * unscaled;
  }
  return add_lanes(squares);
}

/// C with C Cᵀ = D, and C⁻¹; both 0 above the diagonal.
void factorise(const Mat3& D, Mat3& C, Mat3& inverse) {
  C.setZero();
  inverse.setZero();
  C(0, 0) = std::sqrt(D(0, 0));
  inverse(0, 0) = 1.0 / C(0, 0);
  C(1, 0) = D(1, 0) * inverse(0, 0);
  C(2, 0) = D(2, 0) * inverse(0, 0);
  C(1, 1) = std::sqrt(D(1, 1) - C(1, 0) * C(1, 0));
  inverse(1, 1) = 1.0 / C(1, 1);
  C(2, 1) = (D(2, 1) - C(2, 0) * C(1, 0)) * inverse(1, 1);
  C(2, 2) = std::sqrt(D(2, 2) - C(2, 0) * C(2, 0) - C(2, 1) * C(2, 1));
  inverse(2, 2) = 1.0 / C(2, 2);
  inverse(1, 0) = -C(1, 0) * inverse(0, 0) * inverse(1, 1);
  inverse(2, 1) = -C(2, 1) * inverse(1, 1) * inverse(2, 2);
  inverse(2, 0) = -(C(2, 0) * inverse(0, 0) + C(2, 1) * inverse(1, 0)) * inverse(2, 2);
}

/// With rows and columns scaled: sign Cᵢ⁻¹ Aᵢⱼ Cⱼ⁻ᵀ of all blocks of a kind. `scale`: C⁻¹, below the diagonal
/// and on it, 3 columns of four a row.
ARGIL_EVERY_PROCESSOR void scale_blocks(const BlockRows& blocks, const int* source, const double* from,
                                        const float* scale, float sign, std::ptrdiff_t num_rows, float* to) {
  for (std::ptrdiff_t row = 0; row < num_rows; ++row) {
    Floats4 left[3];
    for (int k = 0; k < 3; ++k) left[k] = sign * *four_at(scale + 12 * row + 4 * k);
    for (std::ptrdiff_t b = blocks.begin[row]; b < blocks.begin[row + 1]; ++b) {
      const float* right = scale + 12 * static_cast<std::ptrdiff_t>(blocks.column[b]);
      Floats4 a[3];
      for (int k = 0; k < 3; ++k) {
        Quad column;
        read(from + 9 * static_cast<std::ptrdiff_t>(source[b]) + 3 * k, column);
        a[k] = __builtin_convertvector(column, Floats4);
      }
      const Floats4 scaled[3] = {a[0] * right[0], a[0] * right[1] + a[1] * right[5],
                                 a[0] * right[2] + a[1] * right[6] + a[2] * right[10]};
      for (int k = 0; k < 3; ++k)  // the fourth number is the first of what is written next
        *four_at(to + 9 * b + 3 * k) =
            left[0] * scaled[k][0] + left[1] * scaled[k][1] + left[2] * scaled[k][2];
    }
  }
}

}  // namespace

ShortSsor::ShortSsor(const linear::BlockMatrix& matrix, SsorOrder order, int threads)
    : m_order(std::move(order)), m_threads(threads), m_sums(m_order.group_begin.size() - 1) {
  std::vector<int> place(m_order.rows.size()), group(m_order.rows.size());
  const std::vector<int>& begin = m_order.group_begin;
  for (std::size_t g = 0; g + 1 < begin.size(); ++g)
    for (int i = begin[g]; i < begin[g + 1]; ++i) {
      const auto row = static_cast<std::size_t>(m_order.rows[static_cast<std::size_t>(i)]);
      place[row] = i;
      group[row] = static_cast<int>(g);
    }
  const int apart = m_order.is_last_apart ? static_cast<int>(begin.size()) - 2 : -1;
  std::vector<std::pair<int, int>> blocks;  // of a row, by place
  for (const int row : m_order.rows) {
    const auto r = static_cast<std::size_t>(row);
    blocks.clear();
    for (int b = matrix.row_begin[r]; b < matrix.row_begin[r + 1]; ++b)
      blocks.emplace_back(place[static_cast<std::size_t>(matrix.column[static_cast<std::size_t>(b)])], b);
    std::sort(blocks.begin(), blocks.end());
    const auto is_swept = [&](int column) {
      const int other = group[static_cast<std::size_t>(m_order.rows[static_cast<std::size_t>(column)])];
      return other == group[r] || other == apart || group[r] == apart;
    };
    for (const auto& [column, b] : blocks)
      if (!is_swept(column))
        m_other.add(column, b);
      else if (column < place[r])
        m_lower.add(column, b);
    std::reverse(blocks.begin(), blocks.end());
    for (const auto& [column, b] : blocks)
      if (is_swept(column) && column > place[r]) m_upper.add(column, b);
    for (Blocks* kind : {&m_upper, &m_other, &m_lower})
      kind->begin.push_back(static_cast<int>(kind->column.size()));
  }
  for (Blocks* kind : {&m_upper, &m_other, &m_lower}) kind->values.resize(9 * kind->source.size() + 1);
  const auto num_rows = static_cast<std::size_t>(matrix.num_rows());
  for (std::vector<float>* vector : {&m_r, &m_p, &m_t, &m_s, &m_x}) vector->assign(4 * num_rows, 0.0F);
  m_unscale.assign(12 * num_rows, 0.0F);
  m_scale.assign(12 * num_rows, 0.0F);
}

void ShortSsor::update(const linear::BlockMatrix& matrix) {
  const int num_rows = matrix.num_rows();
  for (int row = 0; row < num_rows; ++row) {
    const int from = m_order.rows[static_cast<std::size_t>(row)];
    const Mat3 diagonal = matrix.block(matrix.diagonal[static_cast<std::size_t>(from)]);
    Mat3 C, inverse;
    factorise(diagonal, C, inverse);
    for (int k = 0; k < 9; ++k) {
      const auto at = static_cast<std::size_t>(12 * row + 4 * (k / 3) + k % 3);
      m_unscale[at] = static_cast<float>(C(k));
      m_scale[at] = static_cast<float>(inverse(k));
    }
  }
  const auto take = [&](Blocks& blocks, float sign) {
    scale_blocks({blocks.begin.data(), blocks.column.data(), nullptr}, blocks.source.data(),
                 matrix.values.data(), m_scale.data(), sign, num_rows, blocks.values.data());
  };
  take(m_upper, -1.0F);
  take(m_other, 1.0F);
  take(m_lower, -1.0F);
}

SsorArrays ShortSsor::arrays() {
  const auto rows = [](const Blocks& blocks) {
    return BlockRows{blocks.begin.data(), blocks.column.data(), blocks.values.data()};
  };
  return {rows(m_upper), rows(m_other), rows(m_lower), m_unscale.data(), m_r.data(),
          m_p.data(),    m_t.data(),    m_s.data(),    m_x.data()};
}

/// Σ body(begin, end) over groups first … last−1, on all threads.
template <class Body>
double ShortSsor::sum_groups(std::size_t first, std::size_t last, Body body) {
  const std::vector<int>& begin = m_order.group_begin;
  parallel_for(static_cast<std::ptrdiff_t>(last - first), last - first > 1 ? m_threads : 1,
               [&](std::ptrdiff_t i) {
                 const std::size_t g = first + static_cast<std::size_t>(i);
                 m_sums[g] = body(begin[g], begin[g + 1]);
               });
  double total = 0.0;
  for (std::size_t g = first; g < last; ++g) total += m_sums[g];
  return total;
}

/// Over all of them, each by itself.
template <class Body>
double ShortSsor::sum_groups(Body body) {
  return sum_groups(0, m_sums.size(), body);
}

/// Groups as they must come for (1+L)⁻¹, and for (1+L)⁻ᵀ.
template <class Body>
double ShortSsor::go_forth(Body body) {
  const std::size_t num_first = m_sums.size() - (m_order.is_last_apart ? 1 : 0);
  const double sum = sum_groups(0, num_first, body);
  return sum + sum_groups(num_first, m_sums.size(), body);
}
template <class Body>
void ShortSsor::go_back(Body body) {
  const std::size_t num_first = m_sums.size() - (m_order.is_last_apart ? 1 : 0);
  sum_groups(num_first, m_sums.size(), body);
  sum_groups(0, num_first, body);
}

/// r = C⁻¹ b / first, p = x = 0.
void ShortSsor::set_start(const Points& b, double first) {
  const SsorArrays a = arrays();
  sum_groups([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const double* from = b.data() + 3 * m_order.rows.data()[row];
      const Floats4 of_row = {static_cast<float>(from[0] / first), static_cast<float>(from[1] / first),
                              static_cast<float>(from[2] / first), 0.0F};
      *four_at(a.r + 4 * row) = multiply(m_scale.data() + 12 * row, of_row);
      *four_at(a.p + 4 * row) = *four_at(a.x + 4 * row) = Floats4{};
    }
    return 0.0;
  });
}

/// x = first C⁻ᵀ x.
void ShortSsor::write_solution(double first, Points& x) {
  const SsorArrays a = arrays();
  x.resize(3, static_cast<Eigen::Index>(m_order.rows.size()));
  sum_groups([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const Floats4 of_row = multiply_transposed(m_scale.data() + 12 * row, *four_at(a.x + 4 * row));
      for (int k = 0; k < 3; ++k) x(k, m_order.rows.data()[row]) = first * static_cast<double>(of_row[k]);
    }
    return 0.0;
  });
}

ShortSsor::Report ShortSsor::solve(const Points& b, double tolerance, int max_iterations, Points& x) {
  const double first = b.norm();
  const SsorArrays a = arrays();
  set_start(b, first);
  double rr = go_forth([&](std::ptrdiff_t begin, std::ptrdiff_t end) { return substitute(a, begin, end); });
  Report report;
  report.residual = 1.0;
  double unscale = 1.0 / std::sqrt(rr);  // residual over ‖r‖
  double last_rr = std::numeric_limits<double>::infinity();
  while (report.residual > tolerance && report.iterations < max_iterations) {
    const auto beta = static_cast<float>(rr / last_rr);
    go_back([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      sweep_back(a, beta, begin, end);
      return 0.0;
    });
    const double curvature =
        go_forth([&](std::ptrdiff_t begin, std::ptrdiff_t end) { return sweep_forth(a, begin, end); });
    if (!(curvature > 0.0)) return report;
    const auto alpha = static_cast<float>(rr / curvature);
    last_rr = rr;
    rr = sum_groups([&](std::ptrdiff_t begin, std::ptrdiff_t end) { return advance(a, alpha, begin, end); });
    ++report.iterations;
    if (unscale * std::sqrt(rr) > tolerance) continue;
    report.residual = std::sqrt(sum_groups(
        [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return compute_residual(a, begin, end); }));
    unscale = report.residual / std::sqrt(rr);
    ++report.checks;
  }
  report.converged = report.residual <= tolerance;
  write_solution(first, x);
  return report;
}

}  // namespace argil::bench
