#pragma once

#include <array>

#include "base/lanes.h"
#include "contact/ccd.h"

namespace argil::contact {

/// The paths of four pairs side by side: [point][coordinate], points as in PairPath.
struct FourPairs {
  static constexpr int kCount = 4;
  Quad t0[4][3];
  Quad t1[4][3];
};

/// One point of each pair: these vertices. Reads four numbers of each, so that x must have a column more.
void set_points(FourPairs& pairs, int point, const Points& x_t0, const Points& x_t1,
                const std::array<int, FourPairs::kCount>& vertices);
/// The same vertex in all pairs.
void set_points(FourPairs& pairs, int point, const Points& x_t0, const Points& x_t1, int vertex);

/// Of which pairs may the four points come to lie in one plane, or as near to that as lets them be
/// `minimum_separation` apart? Bit i for pair i. The others cannot meet: their coplanarity's coefficients
/// have one sign, beyond their rounding (ccd.h).
unsigned find_coplanar(PairKind kind, const FourPairs& pairs, double minimum_separation = 0.0);

/// Of which pairs of edges may the lines be nearest to one another within both edges, at t = 0 or 1? Bit i
/// for pair i; nearly parallel ones are among them.
unsigned find_alongside(const FourPairs& pairs);

}  // namespace argil::contact
