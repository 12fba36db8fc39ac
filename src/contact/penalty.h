#pragma once

#include "contact/ccd.h"

namespace argil::contact {

struct Interval {
  double begin = 0.0;
  double end = 0.0;
};

/// Penetration of one pair over one interval of time, t from 0 to 1, with unit stiffness (eqs. 7 and 8).
struct Penalty {
  std::array<Interval, 2> intervals;  ///< penetration intervals; a cubic has at most two
  int num_intervals = 0;
  Vec3 integral = Vec3::Zero();  ///< ∫ nᵀ(p−q) n dt over them [m]; n unit, see below
  double duration = 0.0;         ///< their total length
  std::array<double, 4> weights =
      {};  ///< shares of the four points at the first entry (0 … 1; each feature sums to 1)
  double orientation = 1.0;  ///< edge-edge: n = orientation·(a×b)/|a×b|
  bool inside_at_end = false;
};

/// Eq. 7: p is the vertex, q the face's point, n the face's unit normal at each moment. On the body's face,
/// the force of a unit stiffness is `integral` (inward, as nᵀ(p−q) < 0 inside); where the vertex is the
/// body's, its negative. An interval opens where the vertex crosses the plane from outside within the
/// triangle (a margin of kInsideMargin takes part, so that no vertex slips between two faces) and closes at
/// the next crossing outwards, or at `until` when the vertex leaves the face sideways at that time.
Penalty compute_vertex_face_penalty(const PairPath& path, bool inside_at_start, double until = 1.0);

/// Does a vertex that starts outside go in through the face?
bool enters_face(const PairPath& path);

/// Eq. 8: p on edge a, q on edge b, n the edges' common unit normal, turned so that nᵀ(p−q) > 0 before the
/// entry. `orientation` (±1) is used when inside_at_start; 0 finds it so that the start lies inside. On b's
/// body the force is `integral`. Opens where both edges' parameters lie in [0, 1]; where only their lines
/// cross, the edges pass each other, and with an orientation of 0 the next crossing may open. Edges that
/// become parallel without meeting cross nothing.
Penalty compute_edge_edge_penalty(const PairPath& path, bool inside_at_start, double orientation);

/// Barycentric margin within which a crossing counts as inside a feature.
inline constexpr double kInsideMargin = 1e-9;

/// Positions at time t.
std::array<Vec3, 4> interpolate(const PairPath& path, double t);

/// Barycentric coordinates (of f0, f1, f2) of the projection of `p` onto the triangle's plane.
Vec3 compute_barycentric(const Vec3& p, const Vec3& f0, const Vec3& f1, const Vec3& f2);

/// Edges whose sine² of the angle between them is no more count as parallel.
inline constexpr double kParallel = 1e-14;

/// Parameters (s, r) of the closest points a0+s(a1−a0), b0+r(b1−b0) of the two edges' lines; (½, ½) when
/// parallel.
Eigen::Vector2d compute_line_parameters(const std::array<Vec3, 4>& p);

}  // namespace argil::contact
