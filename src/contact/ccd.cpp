#include "contact/ccd.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace argil::contact {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2.0;

double largest_coordinate(const PairPath& path) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 4; ++i)
    largest = std::max({largest, path.t0[i].cwiseAbs().maxCoeff(), path.t1[i].cwiseAbs().maxCoeff()});
  return largest;
}

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

/// Difference of the two features' points with parameters u, v at an end of the motion.
Vec3 evaluate(PairKind kind, const std::array<Vec3, 4>& p, double u, double v) {
  if (kind == PairKind::vertex_face) return p[0] - (p[1] + u * (p[2] - p[1]) + v * (p[3] - p[1]));
  return (p[0] + u * (p[1] - p[0])) - (p[2] + v * (p[3] - p[2]));
}

struct Box {
  std::array<double, 3> low;    // t, u, v
  std::array<double, 3> width;  // powers of two, so halving is exact
};

using Corners = std::array<Vec3, 8>;  // bit 0: t, bit 1: u, bit 2: v

Corners evaluate_corners(PairKind kind, const PairPath& path, const Box& box) {
  Corners corners;
  for (std::size_t uv = 0; uv < 4; ++uv) {
    const double u = box.low[1] + (uv & 1U ? box.width[1] : 0.0);
    const double v = box.low[2] + (uv & 2U ? box.width[2] : 0.0);
    const Vec3 at0 = evaluate(kind, path.t0, u, v);
    const Vec3 at1 = evaluate(kind, path.t1, u, v);
    corners[2 * uv] = at0 + box.low[0] * (at1 - at0);
    corners[2 * uv + 1] = at0 + (box.low[0] + box.width[0]) * (at1 - at0);
  }
  return corners;
}

/// How far the difference moves along each parameter, at most over the box's edges.
std::size_t find_widest(const Corners& corners, double& extent) {
  std::array<double, 3> span = {0.0, 0.0, 0.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t bit = std::size_t{1} << axis;
    for (std::size_t c = 0; c < 8; ++c)
      if (!(c & bit))
        span[axis] = std::max(span[axis], (corners[c | bit] - corners[c]).cwiseAbs().maxCoeff());
  }
  const auto widest = std::max_element(span.begin(), span.end());
  extent = *widest;
  return static_cast<std::size_t>(widest - span.begin());
}

bool excludes_zero(const Corners& corners, double tolerance) {
  Vec3 low = corners[0];
  Vec3 high = corners[0];
  for (const Vec3& c : corners) {
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  return (low.array() > tolerance).any() || (high.array() < -tolerance).any();
}

/// Are the boxes swept by the two features apart on some axis?
bool are_boxes_apart(PairKind kind, const PairPath& path) {
  const std::size_t split = kind == PairKind::vertex_face ? 1 : 2;
  Vec3 low_a = path.t0[0].cwiseMin(path.t1[0]);
  Vec3 high_a = path.t0[0].cwiseMax(path.t1[0]);
  for (std::size_t i = 1; i < split; ++i) {
    low_a = low_a.cwiseMin(path.t0[i]).cwiseMin(path.t1[i]);
    high_a = high_a.cwiseMax(path.t0[i]).cwiseMax(path.t1[i]);
  }
  Vec3 low_b = path.t0[split].cwiseMin(path.t1[split]);
  Vec3 high_b = path.t0[split].cwiseMax(path.t1[split]);
  for (std::size_t i = split + 1; i < 4; ++i) {
    low_b = low_b.cwiseMin(path.t0[i]).cwiseMin(path.t1[i]);
    high_b = high_b.cwiseMax(path.t0[i]).cwiseMax(path.t1[i]);
  }
  return (low_a.array() > high_b.array()).any() || (low_b.array() > high_a.array()).any();
}

}  // namespace

std::array<double, 4> compute_coplanarity(PairKind kind, const PairPath& path) {
  // Edge-edge: the same determinant of a1−a0, b1−b0 and b0−a0, written with "face" edges a1−a0, b1−b0.
  const bool face = kind == PairKind::vertex_face;
  const auto edge1 = [&](const std::array<Vec3, 4>& p) -> Vec3 { return face ? p[2] - p[1] : p[1] - p[0]; };
  const auto edge2 = [&](const std::array<Vec3, 4>& p) -> Vec3 { return face ? p[3] - p[1] : p[3] - p[2]; };
  const auto offset = [&](const std::array<Vec3, 4>& p) -> Vec3 { return face ? p[0] - p[1] : p[0] - p[2]; };
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
  // Differences d̂ of coordinates up to M carry an error ≤ u·2M each against extents up to L; the triple
  // product of three of them adds fewer than 32 roundings of terms ≤ 6·(2L)³ … the constants below are
  // rounded up generously.
  const double extent = 2.0 * compute_extent(path);
  const double coordinate = 2.0 * largest_coordinate(path);
  return 128.0 * kUnitRoundoff * extent * extent * (extent + coordinate);
}

std::optional<double> find_time_of_impact(PairKind kind, const PairPath& path) {
  if (are_boxes_apart(kind, path)) return {};
  const std::array<double, 4> c = compute_coplanarity(kind, path);
  const double error = coplanarity_error_bound(path);
  if (*std::min_element(c.begin(), c.end()) > error || *std::max_element(c.begin(), c.end()) < -error)
    return {};

  // evaluate() and the interpolation in t take 6 roundings of values ≤ 4M.
  const double rounding = 32.0 * kUnitRoundoff * largest_coordinate(path);
  const double smallest = std::max(kSeparation * compute_extent(path), 4.0 * rounding);
  constexpr int kMaxBoxes =
      1 << 16;  // degenerate pairs can touch along a line; beyond this the answer stays conservative
  constexpr std::size_t kMaxDepth = 192;
  std::array<Box, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
  double earliest = std::numeric_limits<double>::infinity();
  for (int boxes = 0; depth > 0; ++boxes) {
    const Box box = stack[--depth];
    if (box.low[0] >= earliest) continue;
    if (kind == PairKind::vertex_face && box.low[1] + box.low[2] > 1.0) continue;
    const Corners corners = evaluate_corners(kind, path, box);
    if (excludes_zero(corners, rounding)) continue;
    double extent = 0.0;
    const std::size_t axis = find_widest(corners, extent);
    if (extent <= smallest || boxes >= kMaxBoxes || depth + 2 > kMaxDepth) {
      earliest = box.low[0];
      continue;
    }
    Box first = box;
    first.width[axis] *= 0.5;
    Box second = first;
    second.low[axis] += first.width[axis];
    stack[depth++] = second;  // the earlier half is looked at first
    stack[depth++] = first;
  }
  if (!std::isfinite(earliest)) return {};
  return earliest;
}

}  // namespace argil::contact
