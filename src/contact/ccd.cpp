#include "contact/ccd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace argil::contact {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

constexpr double kUnderflow = 1e-300;  // above what is lost where a product leaves the normal numbers

using Four = std::array<Vec3, 4>;

struct Directions {
  std::array<Vec3, 8> d;
  std::size_t count = 0;
  void add(const Vec3& direction) { d[count++] = direction; }
};

/// Extent of the eight points in space: edge of their bounding box.
double compute_extent(const PairPath& path) {
  Vec3 low = path.t0[0];
  Vec3 high = path.t0[0];
  for (std::size_t i = 0; i < 4; ++i) {
    low = low.cwiseMin(path.t0[i]).cwiseMin(path.t1[i]);
    high = high.cwiseMax(path.t0[i]).cwiseMax(path.t1[i]);
  }
  return (high - low).maxCoeff();
}

/// Comparisons cannot tell where a point is that is not a number.
bool is_finite(const PairPath& path) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < 4; ++i) sum += path.t0[i] + path.t1[i];
  if (std::isfinite(sum.sum())) return true;
  for (std::size_t i = 0; i < 4; ++i)  // not so when the sum alone is too large
    if (!path.t0[i].allFinite() || !path.t1[i].allFinite()) return false;
  return true;
}

/// Number of points of the first feature; the others are the second's.
std::size_t first_feature_size(PairKind kind) {
  return kind == PairKind::vertex_face ? 1 : 2;
}

/// Are the boxes swept by the two features apart on some axis? Compares given numbers only: exact.
bool are_boxes_apart(PairKind kind, const PairPath& path) {
  const std::size_t split = first_feature_size(kind);
  std::array<Vec3, 2> low;
  std::array<Vec3, 2> high;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t side = i < split ? 0 : 1;
    const bool is_first = i == 0 || i == split;
    low[side] = path.t0[i].cwiseMin(is_first ? path.t1[i] : low[side].cwiseMin(path.t1[i]).eval());
    high[side] = path.t0[i].cwiseMax(is_first ? path.t1[i] : high[side].cwiseMax(path.t1[i]).eval());
  }
  return (low[0].array() > high[1].array()).any() || (low[1].array() > high[0].array()).any();
}

/// can_meet for coordinates that are finite.
bool passes_filter(PairKind kind, const PairPath& path) {
  if (are_boxes_apart(kind, path)) return false;
  const std::array<double, 4> c = compute_coplanarity(kind, path);
  if (!std::isfinite(c[0] + c[1] + c[2] + c[3])) return true;  // products beyond the range of double
  const double error = coplanarity_error_bound(path);
  return *std::min_element(c.begin(), c.end()) <= error && *std::max_element(c.begin(), c.end()) >= -error;
}

/// Two convex features that are apart and not degenerate are apart along one of these: the common normal, and
/// the normals within the plane to each side of the triangle, or to each edge. `is_degenerate`: nearly
/// parallel edges or a sliver, for which these may not do.
Directions find_face_directions(PairKind kind, const Four& p, bool& is_degenerate) {
  Directions out;
  const bool face = kind == PairKind::vertex_face;
  const Vec3 a = face ? p[2] - p[1] : p[1] - p[0];
  const Vec3 b = face ? p[3] - p[1] : p[3] - p[2];
  const Vec3 n = a.cross(b);
  constexpr double kSine2 = 1e-6;  // of the angle between the edges
  is_degenerate = !(n.squaredNorm() > kSine2 * a.squaredNorm() * b.squaredNorm());
  out.add(n);
  out.add(n.cross(a));
  out.add(n.cross(b));
  if (face) out.add(n.cross(b - a));
  return out;
}

/// For parallel edges and triangles without area: the longest edge, two directions across it, and the axes.
Directions find_degenerate_directions(PairKind kind, const Four& p) {
  Directions out;
  Vec3 longest = p[3] - p[2];
  const Vec3 second = kind == PairKind::vertex_face ? p[2] - p[1] : p[1] - p[0];
  if (second.squaredNorm() > longest.squaredNorm()) longest = second;
  if (kind == PairKind::vertex_face && (p[3] - p[1]).squaredNorm() > longest.squaredNorm())
    longest = p[3] - p[1];
  Eigen::Index thin = 0;
  longest.cwiseAbs().minCoeff(&thin);
  const Vec3 across = longest.cross(Vec3::Unit(thin));
  out.add(longest);
  out.add(across);
  out.add(across.cross(longest));
  for (Eigen::Index axis = 0; axis < 3; ++axis) out.add(Vec3::Unit(axis));
  return out;
}

/// Until which share of [now, 1] do all differences of the features' points keep one sign along d? With fixed
/// d each difference is linear in time, so its values at `now` and 1 tell. `error` bounds the rounding of one
/// value for |d|₁ = 1. 0: not apart now.
double find_separated_share(PairKind kind, const Vec3& d, const Four& now, const Four& end, double error) {
  const std::size_t split = first_feature_size(kind);
  const double bound = error * d.cwiseAbs().sum() + kUnderflow;
  constexpr double kOverflow = 1e280;  // the differences along d may be some 1e15 times larger
  if (!(bound < kOverflow)) return 0.0;
  double share = 1.0;
  double sign = 0.0;
  for (std::size_t i = 0; i < split; ++i)
    for (std::size_t j = split; j < 4; ++j) {
      const double raw = d.dot(now[i] - now[j]);
      if (sign == 0.0) sign = raw > 0.0 ? 1.0 : -1.0;
      const double here = sign * raw;
      if (!(here > 2.0 * bound)) return 0.0;
      const double there = sign * d.dot(end[i] - end[j]);
      if (!(there > bound)) share = std::min(share, (here - 2.0 * bound) / (here - there));
    }
  return share;
}

}  // namespace

std::array<double, 4> compute_coplanarity(PairKind kind, const PairPath& path) {
  // Edge-edge: the same determinant of a1−a0, b1−b0 and b0−a0, written with "face" edges a1−a0, b1−b0.
  const bool face = kind == PairKind::vertex_face;
  const auto edge1 = [&](const Four& p) -> Vec3 { return face ? p[2] - p[1] : p[1] - p[0]; };
  const auto edge2 = [&](const Four& p) -> Vec3 { return face ? p[3] - p[1] : p[3] - p[2]; };
  const auto offset = [&](const Four& p) -> Vec3 { return face ? p[0] - p[1] : p[0] - p[2]; };
  const Vec3 n0 = edge1(path.t0).cross(edge2(path.t0));
  const Vec3 n1 = edge1(path.t1).cross(edge2(path.t1));
  const Vec3 spin = (edge1(path.t1) - edge1(path.t0)).cross(edge2(path.t1) - edge2(path.t0));
  const Vec3 middle = 0.5 * (n0 + n1 - spin);
  const Vec3 w0 = offset(path.t0);
  const Vec3 w1 = offset(path.t1);
  return {n0.dot(w0), (2.0 * middle.dot(w0) + n0.dot(w1)) / 3.0, (2.0 * middle.dot(w1) + n1.dot(w0)) / 3.0,
          n1.dot(w1)};
}

double coplanarity_error_bound(const PairPath& path) {
  // With every coordinate difference at most L: |n₀|∞, |n₁|∞ ≤ 2L², |spin|∞ ≤ 8L², |middle|∞ ≤ 6L², so that a
  // coefficient sums terms of at most 14·3 L³; on the way to it a term meets at most 14 roundings
  // (differences of given numbers carry a relative one). 42·14 < 1024.
  const double extent = compute_extent(path);
  return 1024.0 * kUnitRoundoff * extent * extent * extent + kUnderflow;
}

bool can_meet(PairKind kind, const PairPath& path) {
  return !is_finite(path) || passes_filter(kind, path);
}

std::optional<double> find_time_of_impact(PairKind kind, const PairPath& path) {
  if (!is_finite(path)) return 0.0;
  if (!passes_filter(kind, path)) return {};

  // Seen from the first point, coordinates are at most L; shifting, interpolating, subtracting and the
  // product with d make fewer than 12 roundings of at most 2L|d|∞ each.
  const double error = 32.0 * kUnitRoundoff * compute_extent(path);
  Four start;
  Four end;
  for (std::size_t i = 0; i < 4; ++i) {
    start[i] = path.t0[i] - path.t0[0];
    end[i] = path.t1[i] - path.t0[0];
  }
  constexpr int kMaxSteps = 256;  // grazing pairs take about 50; beyond, the answer stays on the safe side
  constexpr double kFairProgress = 1e-3;  // of the time left; with less, the other directions are tried too
  double t = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    Four now;
    for (std::size_t i = 0; i < 4; ++i) now[i] = (1.0 - t) * start[i] + t * end[i];
    double share = 0.0;
    const auto try_all = [&](const Directions& directions) {
      for (std::size_t k = 0; k < directions.count && share < 1.0; ++k)
        share = std::max(share, find_separated_share(kind, directions.d[k], now, end, error));
    };
    bool is_degenerate = false;
    try_all(find_face_directions(kind, now, is_degenerate));
    if (share < kFairProgress && is_degenerate) try_all(find_degenerate_directions(kind, now));
    if (share >= 1.0) return {};
    const double later = t + share * (1.0 - t);
    if (!(later > t)) break;
    t = later;
  }
  return t;
}

}  // namespace argil::contact
