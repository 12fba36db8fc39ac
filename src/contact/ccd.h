#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "base/types.h"

namespace argil::contact {

/// Four points in linear motion over one interval, t from 0 to 1. Vertex-face: v, f0, f1, f2. Edge-edge: a0,
/// a1, b0, b1. In the simulation the first feature (v or a) is named first by the caller; the laws say which
/// is the body.
struct PairPath {
  std::array<Vec3, 4> t0;  ///< [m]
  std::array<Vec3, 4> t1;  ///< [m]
};

enum class PairKind { vertex_face, edge_edge };

/// Earliest time at which the vertex meets the triangle, or the edges meet. Safe: no meeting is missed and
/// the time is never later than the true one. A hit may be reported for features that come nearer than the
/// minimum separation: the one asked for [m] and some hundred roundings of their extent (README); a
/// coordinate that is not finite is a hit at 0. The time is then that at which they are so near.
///
/// First the non-penetration filter below. Then time goes forward as long as the features can be shown
/// to be apart: to where the four points may first be in one plane, and by directions: for a fixed d,
/// d·(pᵢ−qⱼ) is linear in t for each pair of points, so that a separation at t lasts until the first of these
/// lines meets zero (less its rounding). Near a meeting this is Newton's iteration from the safe side; it
/// ends where no direction separates.
std::optional<double> find_time_of_impact(PairKind kind, const PairPath& path,
                                          double minimum_separation = 0.0);

/// The coplanarity cubic (compute_coplanarity) on a part of [0, 1], and how far from 0 it can be while the
/// features meet.
struct Coplanarity {
  std::array<double, 4> c = {};
  double bound = 0.0;

  /// One sign throughout: never in one plane.
  bool has_root() const {
    return *std::min_element(c.begin(), c.end()) <= bound && *std::max_element(c.begin(), c.end()) >= -bound;
  }
};

/// What the non-penetration filter tells of a pair.
struct FilteredPair {
  /// False only for features that cannot meet, because their swept boxes are apart or because the cubic's
  /// Bernstein coefficients have one sign throughout, beyond their rounding, so that the four points are
  /// never in one plane [Tang2010]. The README derives the signs.
  bool can_meet = true;
  std::optional<Coplanarity> coplanarity = {};  ///< none where products leave the range of double
};

/// Applies the filter to a pair whose coordinates are finite.
FilteredPair filter_pair(PairKind kind, const PairPath& path, double minimum_separation = 0.0);

/// Coefficients c₀…c₃ in Bernstein form of det(p₁−p₀, p₂−p₀, p₃−p₀)(t): 0 where the four points are coplanar.
/// With n₀, n₁ the normals at the ends, m = (n₀+n₁−(v_b−v_a)×(v_c−v_a))/2 the middle one and w the vectors
/// from the face's first corner to the vertex: n₀·w₀, (2 m·w₀ + n₀·w₁)/3, (2 m·w₁ + n₁·w₀)/3, n₁·w₁
/// [Tang2010].
std::array<double, 4> compute_coplanarity(PairKind kind, const PairPath& path);

/// Bernstein coefficients n₀, m, n₁ of that normal [m²].
std::array<Vec3, 3> compute_normals(PairKind kind, const PairPath& path);

/// Largest rounding error of compute_coplanarity's coefficients.
double coplanarity_error_bound(const PairPath& path);

}  // namespace argil::contact
