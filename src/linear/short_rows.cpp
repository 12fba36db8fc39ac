#include "linear/short_rows.h"

#include "linear/short_vectors.h"

namespace argil::linear {
namespace {

/// Sums of one row, one for each number of a block's column, of two blocks side by side.
struct RowSum {
  Floats8 of[3] = {};
};

/// Six numbers of a pair's columns meet those of two rows of x; the two after them meet its 0.
ARGIL_INLINE void add_pair(const float* pair, const float* x, const float* other, RowSum& sum) {
  const Floats8 both = __builtin_shufflevector(*four_at(x), *four_at(other), 0, 1, 2, 3, 4, 5, 6, 7);
  sum.of[0] += *eight_at(pair) * __builtin_shufflevector(both, both, 0, 0, 0, 4, 4, 4, 3, 3);
  sum.of[1] += *eight_at(pair + 6) * __builtin_shufflevector(both, both, 1, 1, 1, 5, 5, 5, 3, 3);
  sum.of[2] += *eight_at(pair + 12) * __builtin_shufflevector(both, both, 2, 2, 2, 6, 6, 6, 3, 3);
}

ARGIL_INLINE void add_pairs(const ShortRows& a, int begin, int end, const float* x, RowSum& sum) {
  const float* pair = a.values + ShortRows::kPair * static_cast<std::ptrdiff_t>(begin);
  const int* column = a.column + 2 * static_cast<std::ptrdiff_t>(begin);
  for (int i = begin; i < end; ++i, pair += ShortRows::kPair, column += 2)
    add_pair(pair, x + 4 * static_cast<std::ptrdiff_t>(column[0]),
             x + 4 * static_cast<std::ptrdiff_t>(column[1]), sum);
}

ARGIL_INLINE void add_up(const RowSum& sum, Floats4& row) {
  const Floats8 all = (sum.of[0] + sum.of[1]) + sum.of[2];
  const Floats8 zero = {};
  row = __builtin_shufflevector(all, zero, 0, 1, 2, 8) + __builtin_shufflevector(all, zero, 3, 4, 5, 8);
}

/// Asks for a part's numbers some rows before they are needed: parts of successive rows do not lie side by
/// side, which the processor would see by itself.
ARGIL_INLINE void ask_for(const ShortRows& a, int begin) {
  const float* at = a.values + ShortRows::kPair * static_cast<std::ptrdiff_t>(begin);
  for (int line = 0; line < 4; ++line) __builtin_prefetch(at + 16 * line);
}
constexpr int kAhead = 8;

}  // namespace

ARGIL_EVERY_PROCESSOR Substituted substitute(const ShortRows& rows_of, const int* rows, int begin, int end,
                                             const float* r, float* rho) {
  const ShortRows a = rows_of;  // which stores below do not change
  Quad squares = {}, scaled = {};
  for (int i = begin; i < end; ++i) {
    const std::ptrdiff_t row = rows[i];
    const RowParts parts = a.parts[row];
    RowSum sum;
    add_pairs(a, parts.begin, parts.middle, rho, sum);
    Floats4 before, start, Drho;
    add_up(sum, before);
    const Floats4 of_r = *four_at(r + 4 * row);
    apply_block(a.inverse + 12 * row, of_r, start);
    const Floats4 of_rho = start - before;
    *four_at(rho + 4 * row) = of_rho;
    apply_block(a.diagonal + 12 * row, of_rho, Drho);
    add_up(of_r * of_r, squares);
    add_up(of_rho * Drho, scaled);
  }
  return {add_lanes(squares), add_lanes(scaled)};
}

ARGIL_EVERY_PROCESSOR void sweep_back(const ShortRows& rows_of, const int* rows, int begin, int end,
                                      float beta, const float* rho, float* p, float* t) {
  const ShortRows a = rows_of;
  for (int i = end - 1; i >= begin; --i) {
    const std::ptrdiff_t row = rows[i];
    if (i - kAhead >= begin) ask_for(a, a.parts[rows[i - kAhead]].middle);
    const RowParts parts = a.parts[row];
    RowSum sum;
    add_pairs(a, parts.middle, parts.end, t, sum);
    Floats4 after;
    add_up(sum, after);
    const Floats4 of_p = *four_at(rho + 4 * row) + beta * *four_at(p + 4 * row);
    *four_at(p + 4 * row) = of_p;
    *four_at(t + 4 * row) = of_p - after;
  }
}

ARGIL_EVERY_PROCESSOR double sweep_forth(const ShortRows& rows_of, const int* rows, int begin, int end,
                                         const float* p, const float* t, float* s) {
  const ShortRows a = rows_of;
  Quad dot = {};
  for (int i = begin; i < end; ++i) {
    const std::ptrdiff_t row = rows[i];
    if (i + kAhead < end) ask_for(a, a.parts[rows[i + kAhead]].begin);
    const RowParts parts = a.parts[row];
    RowSum sum;
    add_pairs(a, parts.begin, parts.middle, s, sum);
    Floats4 before, product;
    add_up(sum, before);
    const Floats4 of_p = *four_at(p + 4 * row);
    const Floats4 of_t = *four_at(t + 4 * row);
    const Floats4 of_s = (of_p - of_t) - before;
    *four_at(s + 4 * row) = of_s;
    apply_block(a.diagonal + 12 * row, of_t + of_s, product);
    add_up(of_p * product, dot);
  }
  return add_lanes(dot);
}

ARGIL_EVERY_PROCESSOR double compute_squares(const ShortRows& rows_of, std::ptrdiff_t begin,
                                             std::ptrdiff_t end, const float* rho) {
  const ShortRows a = rows_of;
  Quad squares = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    const RowParts parts = a.parts[row];
    RowSum sum;
    add_pairs(a, parts.begin, parts.middle, rho, sum);
    Floats4 before, r;
    add_up(sum, before);
    apply_block(a.diagonal + 12 * row, *four_at(rho + 4 * row) + before, r);
    add_up(r * r, squares);
  }
  return add_lanes(squares);
}

ARGIL_EVERY_PROCESSOR double advance(const ShortRows& rows_of, std::ptrdiff_t begin, std::ptrdiff_t end,
                                     float alpha, const float* t, const float* s, float* x, float* rho) {
  const ShortRows a = rows_of;
  Quad scaled = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    const Floats4 of_t = *four_at(t + i);
    const Floats4 of_rho = *four_at(rho + i) - alpha * (of_t + *four_at(s + i));
    *four_at(x + i) += alpha * of_t;
    *four_at(rho + i) = of_rho;
    Floats4 product;
    apply_block(a.diagonal + 3 * i, of_rho, product);
    add_up(of_rho * product, scaled);
  }
  return add_lanes(scaled);
}

namespace {

template <int Count>
ARGIL_INLINE void multiply_row(const ShortRows& a, std::ptrdiff_t row, const float* const (&x)[Count],
                               Floats4 (&y)[Count]) {
  const RowParts parts = a.parts[row];
  const float* pair = a.values + ShortRows::kPair * static_cast<std::ptrdiff_t>(parts.begin);
  const int* column = a.column + 2 * static_cast<std::ptrdiff_t>(parts.begin);
  RowSum sum[Count];
  for (int i = parts.begin; i < parts.end; ++i, pair += ShortRows::kPair, column += 2)
    for (int k = 0; k < Count; ++k)
      add_pair(pair, x[k] + 4 * static_cast<std::ptrdiff_t>(column[0]),
               x[k] + 4 * static_cast<std::ptrdiff_t>(column[1]), sum[k]);
  for (int k = 0; k < Count; ++k) {
    Floats4 others;
    add_up(sum[k], others);
    apply_block(a.diagonal + 12 * row, *four_at(x[k] + 4 * row) + others, y[k]);
  }
}

}  // namespace

ARGIL_EVERY_PROCESSOR double multiply(const ShortRows& rows_of, std::ptrdiff_t begin, std::ptrdiff_t end,
                                      const float* x, float* y) {
  const ShortRows a = rows_of;
  Quad dot = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    Floats4 out[1];
    multiply_row<1>(a, row, {x}, out);
    *four_at(y + 4 * row) = out[0];
    add_up(out[0] * *four_at(x + 4 * row), dot);
  }
  return add_lanes(dot);
}

ARGIL_EVERY_PROCESSOR void multiply_three(const ShortRows& rows_of, std::ptrdiff_t begin, std::ptrdiff_t end,
                                          const float* const (&x)[3], float* const (&y)[3]) {
  const ShortRows a = rows_of;
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    Floats4 out[3];
    multiply_row<3>(a, row, x, out);
    for (int k = 0; k < 3; ++k) *four_at(y[k] + 4 * row) = out[k];
  }
}

ARGIL_EVERY_PROCESSOR ShortSums advance_blocks(const ShortRows& a, std::ptrdiff_t begin, std::ptrdiff_t end,
                                               float alpha, float beta, const float* z, float* w,
                                               const ShortIterate& iterate) {
  const ShortIterate to = iterate;
  const float* inverse = a.inverse;
  Quad rr = {}, rz = {};
  for (std::ptrdiff_t i = 4 * begin; i < 4 * end; i += 4) {
    const Floats4 p = *four_at(z + i) + beta * *four_at(to.p + i);
    const Floats4 q = *four_at(w + i) + beta * *four_at(to.q + i);
    const Floats4 r = *four_at(to.r + i) - alpha * q;
    *four_at(to.p + i) = p;
    *four_at(to.q + i) = q;
    *four_at(to.x + i) += alpha * p;
    *four_at(to.r + i) = r;
    Floats4 next;
    apply_block(inverse + 3 * i, r, next);
    *four_at(w + i) = next;
    add_up(r * r, rr);
    add_up(r * next, rz);
  }
  return {add_lanes(rr), add_lanes(rz)};
}

ARGIL_EVERY_PROCESSOR void take_pairs(const double* from, const int* source, int begin, int end,
                                      const float* inverse, float* values) {
  const Floats4 left[3] = {*four_at(inverse), *four_at(inverse + 4), *four_at(inverse + 8)};
  for (int b = 2 * begin; b < 2 * end; ++b) {
    float* to = values + ShortRows::kPair * static_cast<std::ptrdiff_t>(b / 2) + 3 * (b % 2);
    for (int k = 0; k < 3; ++k) {
      Floats4 scaled = {};
      if (source[b] >= 0) {
        const double* column = from + 9 * static_cast<std::ptrdiff_t>(source[b]) + 3 * k;
        scaled = left[0] * static_cast<float>(column[0]) + left[1] * static_cast<float>(column[1]) +
                 left[2] * static_cast<float>(column[2]);
      }
      for (int j = 0; j < 3; ++j) to[6 * k + j] = scaled[j];
    }
  }
}

}  // namespace argil::linear
