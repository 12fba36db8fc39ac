#include "contact/ccd.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/nearest.h"

namespace argil::contact {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

constexpr double kRoundedUp = 1.0 + 64.0 * kUnitRoundoff;  // takes up the roundings of a short sum of squares

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

/// Are the boxes swept by the two features more than `separation` apart on some axis? For 0 this compares
/// given numbers only and is exact.
bool are_boxes_apart(PairKind kind, const PairPath& path, double separation) {
  const std::size_t split = first_feature_size(kind);
  std::array<Vec3, 2> low;
  std::array<Vec3, 2> high;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t side = i < split ? 0 : 1;
    const bool is_first = i == 0 || i == split;
    low[side] = path.t0[i].cwiseMin(is_first ? path.t1[i] : low[side].cwiseMin(path.t1[i]).eval());
    high[side] = path.t0[i].cwiseMax(is_first ? path.t1[i] : high[side].cwiseMax(path.t1[i]).eval());
  }
  if (separation == 0.0)
    return (low[0].array() > high[1].array()).any() || (low[1].array() > high[0].array()).any();
  const double least = separation * kRoundedUp;
  return ((low[0] - high[1]).array() > least).any() || ((low[1] - high[0]).array() > least).any();
}

/// None when products leave the range of double. Points of two features that are no more than `separation`
/// apart have n·(p − q) = c, so that |c| ≤ |n| separation, and |n(t)| is a mean of its Bernstein
/// coefficients.
std::optional<Coplanarity> find_coplanarity(PairKind kind, const PairPath& path, double separation) {
  Coplanarity out{compute_coplanarity(kind, path), coplanarity_error_bound(path)};
  if (separation > 0.0) {
    const std::array<Vec3, 3> n = compute_normals(kind, path);
    const double longest = std::max({n[0].stableNorm(), n[1].stableNorm(), n[2].stableNorm()});
    out.bound = (out.bound + longest * separation) * kRoundedUp;
  }
  if (!std::isfinite(out.c[0] + out.c[1] + out.c[2] + out.c[3] + out.bound)) return {};
  return out;
}

/// The same cubic on [t, 1], by de Casteljau's means.
Coplanarity restrict(const Coplanarity& whole, double t) {
  Coplanarity out = whole;
  for (std::size_t level = 1; level < 4; ++level)
    for (std::size_t i = 0; i + level < 4; ++i) out.c[i] = (1.0 - t) * out.c[i] + t * out.c[i + 1];
  return out;
}

/// The share of its interval before which the cubic surely has no root: where the hull of its coefficients
/// meets 0 [Sederberg1990]. 0 when it may start with one, 1 when there is none.
double find_rootless_share(const Coplanarity& cubic) {
  if (std::abs(cubic.c[0]) <= cubic.bound) return 0.0;
  const double sign = cubic.c[0] > 0.0 ? 1.0 : -1.0;
  std::array<double, 4> height;
  for (std::size_t i = 0; i < 4; ++i) height[i] = sign * cubic.c[i] - cubic.bound;
  double share = 1.0;
  for (std::size_t j = 1; j < 4; ++j)
    for (std::size_t i = 0; height[j] <= 0.0 && i < j; ++i)
      if (height[i] > 0.0)
        share = std::min(share, (static_cast<double>(i) +
                                 static_cast<double>(j - i) * height[i] / (height[i] - height[j])) /
                                    3.0);
  return share == 1.0 ? 1.0 : share * (1.0 - 16.0 * kUnitRoundoff);
}

/// Two convex features that are apart and not degenerate are apart along their common normal or one of these:
/// the normals within the plane to each side of the triangle, or to each edge. `is_degenerate`: nearly
/// parallel edges or a sliver, for which these may not do.
Directions find_face_directions(PairKind kind, const Four& p, Vec3& normal, bool& is_degenerate) {
  Directions out;
  const bool face = kind == PairKind::vertex_face;
  const Vec3 a = face ? p[2] - p[1] : p[1] - p[0];
  const Vec3 b = face ? p[3] - p[1] : p[3] - p[2];
  normal = a.cross(b);
  constexpr double kSine2 = 1e-6;  // of the angle between the edges
  is_degenerate = !(normal.squaredNorm() > kSine2 * a.squaredNorm() * b.squaredNorm());
  out.add(normal.cross(a));
  out.add(normal.cross(b));
  if (face) out.add(normal.cross(b - a));
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

Vec3 compute_nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return a + t * (b - a);
}

/// From one feature's nearest point to the other's, of which no more than one is within its feature: along it
/// they are as far apart as they are.
Vec3 find_nearest_direction(PairKind kind, const Four& p) {
  if (kind == PairKind::vertex_face) {
    const Vec3 w = compute_nearest_on_triangle(p[0], p[1], p[2], p[3]).weight;
    return p[0] - w(0) * p[1] - w(1) * p[2] - w(2) * p[3];
  }
  Vec3 shortest = p[0] - compute_nearest_on_segment(p[0], p[2], p[3]);
  for (const Vec3& d : {Vec3(p[1] - compute_nearest_on_segment(p[1], p[2], p[3])),
                        Vec3(p[2] - compute_nearest_on_segment(p[2], p[0], p[1])),
                        Vec3(p[3] - compute_nearest_on_segment(p[3], p[0], p[1]))})
    if (d.squaredNorm() < shortest.squaredNorm()) shortest = d;
  return shortest;
}

/// Until which share of [now, 1] do all differences of the features' points keep one sign along d? With fixed
/// d each difference is linear in time, so its values at `now` and 1 tell. `error` bounds the rounding of one
/// value for |d|₁ = 1. 0: not apart by more than `separation` now.
double find_separated_share(PairKind kind, const Vec3& d, const Four& now, const Four& end, double error,
                            double separation) {
  const std::size_t split = first_feature_size(kind);
  const double bound = error * d.cwiseAbs().sum() + kUnderflow;
  const double apart = separation > 0.0 ? separation * d.stableNorm() * kRoundedUp : 0.0;
  constexpr double kOverflow = 1e280;  // the differences along d may be some 1e15 times larger
  if (!(bound + apart < kOverflow)) return 0.0;
  std::array<double, 4> here;
  for (std::size_t i = 0; i < 4; ++i) here[i] = d.dot(now[i]);
  const bool is_face = split == 1;
  const double low_a = is_face ? here[0] : std::min(here[0], here[1]);
  const double high_a = is_face ? here[0] : std::max(here[0], here[1]);
  const double low_b = is_face ? std::min({here[1], here[2], here[3]}) : std::min(here[2], here[3]);
  const double high_b = is_face ? std::max({here[1], here[2], here[3]}) : std::max(here[2], here[3]);
  const bool is_above = low_a - high_b - apart > 2.0 * bound;
  if (!is_above && !(low_b - high_a - apart > 2.0 * bound)) return 0.0;
  const double sign = is_above ? 1.0 : -1.0;
  std::array<double, 4> there;
  for (std::size_t i = 0; i < 4; ++i) there[i] = d.dot(end[i]);
  double share = 1.0;
  for (std::size_t i = 0; i < split; ++i)
    for (std::size_t j = split; j < 4; ++j) {
      const double first = sign * (here[i] - here[j]) - apart;
      const double last = sign * (there[i] - there[j]) - apart;
      if (!(last > bound)) share = std::min(share, (first - 2.0 * bound) / (first - last));
    }
  return share;
}

}  // namespace

std::array<Vec3, 3> compute_normals(PairKind kind, const PairPath& path) {
  // Edge-edge: the same determinant of a1−a0, b1−b0 and a0−b0, written with "face" edges a1−a0, b1−b0.
  const bool face = kind == PairKind::vertex_face;
  const auto edge1 = [&](const Four& p) -> Vec3 { return face ? p[2] - p[1] : p[1] - p[0]; };
  const auto edge2 = [&](const Four& p) -> Vec3 { return face ? p[3] - p[1] : p[3] - p[2]; };
  const Vec3 n0 = edge1(path.t0).cross(edge2(path.t0));
  const Vec3 n1 = edge1(path.t1).cross(edge2(path.t1));
  const Vec3 spin = (edge1(path.t1) - edge1(path.t0)).cross(edge2(path.t1) - edge2(path.t0));
  return {n0, 0.5 * (n0 + n1 - spin), n1};
}

std::array<double, 4> compute_coplanarity(PairKind kind, const PairPath& path) {
  const auto [n0, middle, n1] = compute_normals(kind, path);
  const std::size_t first = kind == PairKind::vertex_face ? 1 : 2;
  const Vec3 w0 = path.t0[0] - path.t0[first];
  const Vec3 w1 = path.t1[0] - path.t1[first];
  return {n0.dot(w0), (2.0 * middle.dot(w0) + n0.dot(w1)) / 3.0, (2.0 * middle.dot(w1) + n1.dot(w0)) / 3.0,
          n1.dot(w1)};
}

double coplanarity_error_bound(const PairPath& path) {
  // With every coordinate difference at most L: |n₀|∞, |n₁|∞ ≤ 2L², |spin|∞ ≤ 8L², |middle|∞ ≤ 6L², so that a
  // coefficient sums terms of at most 14·3 L³; on the way to it a term meets at most 14 roundings
  // (differences of given numbers carry a relative one). De Casteljau's means on a part of [0, 1] add 9, the
  // rounding of a time where the cubic rises by 6·42 L³ at most another 6. 42·29 < 2048.
  const double extent = compute_extent(path);
  return 2048.0 * kUnitRoundoff * extent * extent * extent + kUnderflow;
}

FilteredPair filter_pair(PairKind kind, const PairPath& path, double separation) {
  if (are_boxes_apart(kind, path, separation)) return {.can_meet = false};
  const std::optional<Coplanarity> coplanarity = find_coplanarity(kind, path, separation);
  return {!coplanarity || coplanarity->has_root(), coplanarity};
}

std::optional<double> find_time_of_impact(PairKind kind, const PairPath& path, double separation) {
  if (!is_finite(path)) return 0.0;
  const auto [can_meet, coplanarity] = filter_pair(kind, path, separation);
  if (!can_meet) return {};

  // Seen from the first point, coordinates are at most L; shifting, interpolating, subtracting and the
  // product with d make fewer than 12 roundings of at most 2L|d|∞ each.
  const double error = 32.0 * kUnitRoundoff * compute_extent(path);
  Four start;
  Four end;
  for (std::size_t i = 0; i < 4; ++i) {
    start[i] = path.t0[i] - path.t0[0];
    end[i] = path.t1[i] - path.t0[0];
  }
  constexpr int kMaxSteps = 256;            // beyond, the answer stays on the safe side
  constexpr double kLeastProgress = 1e-12;  // of the time left; rounding alone can give less: they meet
  constexpr double kFairProgress = 1e-3;    // of the time left; with less, the other directions are tried too
  double t = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    // As long as the four points are not in one plane, the features do not meet.
    const double before = t;
    if (coplanarity) {
      constexpr int kClippings = 4;
      constexpr double kLargeProgress = 0.1;
      double rootless = 1.0;
      for (int i = 0; i < kClippings && rootless > kLargeProgress; ++i) {
        rootless = find_rootless_share(restrict(*coplanarity, t));
        if (rootless >= 1.0) return {};
        t += rootless * (1.0 - t);
      }
    }
    Four now;
    for (std::size_t i = 0; i < 4; ++i) now[i] = (1.0 - t) * start[i] + t * end[i];
    double share = 0.0;
    const auto try_one = [&](const Vec3& d) {
      share = std::max(share, find_separated_share(kind, d, now, end, error, separation));
    };
    const auto try_all = [&](const Directions& directions) {
      for (std::size_t k = 0; k < directions.count && share < 1.0; ++k) try_one(directions.d[k]);
    };
    bool is_degenerate = false;
    Vec3 normal;
    try_all(find_face_directions(kind, now, normal, is_degenerate));
    // The cubic has stood for the normal; close to a meeting its rounding is the larger.
    if (share < kFairProgress) try_one(normal);
    if (share < kFairProgress && is_degenerate) try_all(find_degenerate_directions(kind, now));
    if (share < kFairProgress && separation > 0.0) try_one(find_nearest_direction(kind, now));
    if (share >= 1.0) return {};
    t += share * (1.0 - t);
    if (!(t - before > kLeastProgress * (1.0 - before))) break;
  }
  return t;
}

}  // namespace argil::contact
