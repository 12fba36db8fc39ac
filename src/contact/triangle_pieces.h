#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/types.h"

namespace argil::contact {

/// Share of a triangle on which a linear function with these corner values is negative.
inline double compute_negative_share(const std::array<double, 3>& d) {
  const auto num_negative = std::count_if(d.begin(), d.end(), [](double value) { return value < 0.0; });
  if (num_negative == 0 || num_negative == 3) return num_negative == 3 ? 1.0 : 0.0;
  // The corner that is alone on its side cuts off a triangle similar to none, of this share.
  std::size_t alone = 0;
  while ((d[alone] < 0.0) != (num_negative == 1)) ++alone;
  const double da = d[alone];
  const double cut = da * da / ((da - d[(alone + 1) % 3]) * (da - d[(alone + 2) % 3]));
  return num_negative == 1 ? cut : 1.0 - cut;
}

/// Mean of a triangle's corners.
inline Vec3 find_centre(const std::array<Vec3, 3>& x) {
  return (x[0] + x[1] + x[2]) / 3.0;
}

/// The four parts into which the middles of its edges split a triangle.
inline std::array<std::array<Vec3, 3>, 4> quarter(const std::array<Vec3, 3>& x) {
  const std::array<Vec3, 3> m = {0.5 * (x[0] + x[1]), 0.5 * (x[1] + x[2]), 0.5 * (x[2] + x[0])};
  return {{{x[0], m[0], m[2]}, {m[0], x[1], m[1]}, {m[2], m[1], x[2]}, {m[0], m[1], m[2]}}};
}

}  // namespace argil::contact
