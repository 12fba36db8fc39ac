#pragma once

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

/// Earliest time at which the vertex meets the triangle, or the edges meet; conservative: a meeting is never
/// missed, and a hit may be reported for features that pass at less than kSeparation times the size of their
/// motion. The time is not later than the true one.
///
/// First the swept boxes and the coplanarity cubic's Bernstein coefficients: with one sign throughout, the
/// four points are never in one plane [Tang2010]. Then subdivision of (t, u, v): the difference of the two
/// features' points is linear in each of the three, so that its values at the corners of a box bound it
/// inside the box; a box whose bounds exclude 0 is dropped.
std::optional<double> find_time_of_impact(PairKind kind, const PairPath& path);

/// Relative size of the smallest box: hits are told from misses down to this share of the features' extent.
inline constexpr double kSeparation = 1e-7;

/// Coefficients c₀…c₃ in Bernstein form of det(p₁−p₀, p₂−p₀, p₃−p₀)(t): 0 where the four points are coplanar.
/// With n₀, n₁ the normals at the ends, m = (n₀+n₁−(v_b−v_a)×(v_c−v_a))/2 the middle one and w the vectors
/// from the face's first corner to the vertex: n₀·w₀, (2 m·w₀ + n₀·w₁)/3, (2 m·w₁ + n₁·w₀)/3, n₁·w₁
/// [Tang2010].
std::array<double, 4> compute_coplanarity(PairKind kind, const PairPath& path);

/// Largest rounding error of compute_coplanarity's coefficients.
double coplanarity_error_bound(const PairPath& path);

}  // namespace argil::contact
