#include "contact/four_pairs.h"

#include <cstring>
#include <limits>

#include "contact/penalty.h"

namespace argil::contact {
namespace {

using Mask = long long __attribute__((vector_size(sizeof(Quad))));
using Point = Quad[3];

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

ARGIL_INLINE void subtract(const Point& a, const Point& b, Point& out) {
  for (int k = 0; k < 3; ++k) out[k] = a[k] - b[k];
}

ARGIL_INLINE void cross(const Point& a, const Point& b, Point& out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

ARGIL_INLINE void dot(const Point& a, const Point& b, Quad& out) {
  out = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ARGIL_INLINE unsigned make_bits(const Mask& mask) {
  const Mask bits = mask & Mask{1, 2, 4, 8};
  return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
}

/// Sums to `sum` how long a vector may be: |v|₁ ≥ |v|.
ARGIL_INLINE void add_length(const Point& v, Quad& sum) {
  constexpr long long kNoSign = std::numeric_limits<long long>::max();
  for (int k = 0; k < 3; ++k) {
    Mask bits;
    std::memcpy(&bits, &v[k], sizeof bits);
    bits &= kNoSign;
    Quad size;
    std::memcpy(&size, &bits, sizeof size);
    sum += size;
  }
}

/// See compute_coplanarity: e₁ and e₂, by the points that they lead to and come from, and w = p₀ − p of kW.
/// Written so that what is not a number rules nothing out.
template <int kTo1, int kFrom1, int kTo2, int kFrom2, int kW>
ARGIL_INLINE unsigned find_coplanar(const FourPairs& pairs, double separation) {
  Point e1[2], e2[2], w[2], n[2], middle;
  Quad size = {};  // above every coordinate of e₁, e₂ and w
  for (int end = 0; end < 2; ++end) {
    const Point(&p)[4] = end == 0 ? pairs.t0 : pairs.t1;
    subtract(p[kTo1], p[kFrom1], e1[end]);
    subtract(p[kTo2], p[kFrom2], e2[end]);
    subtract(p[0], p[kW], w[end]);
    cross(e1[end], e2[end], n[end]);
    add_length(e1[end], size);
    add_length(e2[end], size);
    add_length(w[end], size);
  }
  Point turn1, turn2;
  subtract(e1[1], e1[0], turn1);
  subtract(e2[1], e2[0], turn2);
  cross(turn1, turn2, middle);
  for (int k = 0; k < 3; ++k) middle[k] = n[0][k] + n[1][k] - middle[k];  // twice the normal's
  Quad c[4], summand;                                                     // the two in the middle three times
  dot(n[0], w[0], c[0]);
  dot(middle, w[0], c[1]);
  dot(n[0], w[1], summand);
  c[1] += summand;
  dot(middle, w[1], c[2]);
  dot(n[1], w[0], summand);
  c[2] += summand;
  dot(n[1], w[1], c[3]);

  // As coplanarity_error_bound has it, with the size of the differences in place of the extent; a separation
  // lets |c| be as large as |n| times that.
  Quad bound = 2048.0 * kUnitRoundoff * size * size * size + 1e-300;
  if (separation > 0.0) {
    Quad longest = {};
    for (const Point* normal : {&n[0], &middle, &n[1]}) add_length(*normal, longest);
    bound += longest * (separation * (1.0 + 64.0 * kUnitRoundoff));
  }
  const Quad thrice = 3.0 * bound;
  const Mask is_above = (c[0] > bound) & (c[1] > thrice) & (c[2] > thrice) & (c[3] > bound);
  const Mask is_below = (c[0] < -bound) & (c[1] < -thrice) & (c[2] < -thrice) & (c[3] < -bound);
  const Quad sum = c[0] + c[1] + c[2] + c[3];
  const Mask is_finite = sum - sum == Quad{};
  return make_bits(~((is_above | is_below) & is_finite));
}

/// At one end: see compute_line_parameters, whose divisions this does without.
ARGIL_INLINE void find_alongside_at(const Point (&p)[4], Mask& is_alongside) {
  Point a, b, w;
  subtract(p[1], p[0], a);
  subtract(p[3], p[2], b);
  subtract(p[2], p[0], w);
  Quad aa, bb, ww, ab, wa, wb;
  dot(a, a, aa);
  dot(b, b, bb);
  dot(w, w, ww);
  dot(a, b, ab);
  dot(w, a, wa);
  dot(w, b, wb);
  const Quad det = aa * bb - ab * ab;
  const Quad s = wa * bb - wb * ab;
  const Quad r = wa * ab - wb * aa;
  // Each of s, r and det sums two products of at most |w||a||b|² and the like; they and another order of
  // operations meet fewer than 16 roundings.
  const Quad rounding = 32.0 * kUnitRoundoff * (ww + aa + bb) * (aa + bb) + 1e-300;
  const Mask is_beside = (s < -rounding) | (s - det > rounding) | (r < -rounding) | (r - det > rounding);
  is_alongside |= ~(is_beside & (det - 2.0 * kParallel * aa * bb > rounding));
}

}  // namespace

ARGIL_EVERY_PROCESSOR void set_points(FourPairs& pairs, int point, const Points& x_t0, const Points& x_t1,
                                      const std::array<int, FourPairs::kCount>& vertices) {
  const auto gather = [&](const double* x, Point& to) __attribute__((always_inline)) {
    Quad a[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) read(x + 3 * vertices.data()[i], a[i]);
    const Quad xz01 = __builtin_shufflevector(a[0], a[1], 0, 4, 2, 6);
    const Quad xz23 = __builtin_shufflevector(a[2], a[3], 0, 4, 2, 6);
    const Quad y01 = __builtin_shufflevector(a[0], a[1], 1, 5, 3, 7);
    const Quad y23 = __builtin_shufflevector(a[2], a[3], 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(xz01, xz23, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(y01, y23, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7);
  };
  gather(x_t0.data(), pairs.t0[point]);
  gather(x_t1.data(), pairs.t1[point]);
}

ARGIL_EVERY_PROCESSOR void set_points(FourPairs& pairs, int point, const Points& x_t0, const Points& x_t1,
                                      int vertex) {
  for (int k = 0; k < 3; ++k) {
    pairs.t0[point][k] = Quad{} + x_t0.data()[3 * vertex + k];
    pairs.t1[point][k] = Quad{} + x_t1.data()[3 * vertex + k];
  }
}

ARGIL_EVERY_PROCESSOR unsigned find_coplanar(PairKind kind, const FourPairs& pairs,
                                             double minimum_separation) {
  return kind == PairKind::vertex_face ? find_coplanar<2, 1, 3, 1, 1>(pairs, minimum_separation)
                                       : find_coplanar<1, 0, 3, 2, 2>(pairs, minimum_separation);
}

ARGIL_EVERY_PROCESSOR unsigned find_alongside(const FourPairs& pairs) {
  Mask is_alongside = {};
  find_alongside_at(pairs.t0, is_alongside);
  find_alongside_at(pairs.t1, is_alongside);
  return make_bits(is_alongside);
}

}  // namespace argil::contact
