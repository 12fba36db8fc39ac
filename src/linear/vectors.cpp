#include "linear/vectors.h"

#include "base/lanes.h"

namespace argil::linear {
namespace {

/// a·b of `count` numbers, in an order of addition that `count` alone decides.
ARGIL_INLINE double dot(const double* a, const double* b, std::ptrdiff_t count) {
  Lanes even = {}, odd = {}, x, y;
  std::ptrdiff_t i = 0;
  for (; i + 2 * kLanes <= count; i += 2 * kLanes) {
    read(a + i, x);
    read(b + i, y);
    even += x * y;
    read(a + i + kLanes, x);
    read(b + i + kLanes, y);
    odd += x * y;
  }
  double rest = 0.0;
  for (; i < count; ++i) rest += a[i] * b[i];
  even += odd;
  return ((even[0] + even[4]) + (even[2] + even[6])) + ((even[1] + even[5]) + (even[3] + even[7])) + rest;
}

}  // namespace

ARGIL_EVERY_PROCESSOR double compute_dot(const double* a, const double* b, std::ptrdiff_t begin,
                                         std::ptrdiff_t end) {
  return dot(a + 3 * begin, b + 3 * begin, 3 * (end - begin));
}

ARGIL_EVERY_PROCESSOR double advance(double alpha, double beta, const double* z, const double* w,
                                     std::ptrdiff_t begin, std::ptrdiff_t end, const Iterate& to) {
  for (std::ptrdiff_t i = 3 * begin; i < 3 * end; ++i) to.p[i] = z[i] + beta * to.p[i];
  for (std::ptrdiff_t i = 3 * begin; i < 3 * end; ++i) to.q[i] = w[i] + beta * to.q[i];
  for (std::ptrdiff_t i = 3 * begin; i < 3 * end; ++i) to.x[i] += alpha * to.p[i];
  for (std::ptrdiff_t i = 3 * begin; i < 3 * end; ++i) to.r[i] -= alpha * to.q[i];
  return dot(to.r + 3 * begin, to.r + 3 * begin, 3 * (end - begin));
}

ARGIL_EVERY_PROCESSOR double apply_blocks(const double* inverse, const double* r, std::ptrdiff_t begin,
                                          std::ptrdiff_t end, double* z) {
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    const double* in = r + 3 * row;
    Quad column[3];
    for (int k = 0; k < 3; ++k) read(inverse + 9 * row + 3 * k, column[k]);
    const Quad out = column[0] * in[0] + column[1] * in[1] + column[2] * in[2];
    for (int k = 0; k < 3; ++k) z[3 * row + k] = out[k];
  }
  return dot(r + 3 * begin, z + 3 * begin, 3 * (end - begin));
}

}  // namespace argil::linear
