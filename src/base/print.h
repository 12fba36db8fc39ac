#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "base/types.h"

namespace argil {

/// "(0.01, 0, -0.02)": a place [m] for a message, rounded to nanometres.
inline std::string print_place(const Vec3& x) {
  constexpr double kPerMetre = 1e9;
  std::ostringstream text;
  for (int k = 0; k < 3; ++k)
    text << (k == 0 ? "(" : ", ") << std::round(x(k) * kPerMetre) / kPerMetre + 0.0;  // no −0
  text << ")";
  return text.str();
}

}  // namespace argil
