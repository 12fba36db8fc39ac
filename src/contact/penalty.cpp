#include "contact/penalty.h"

#include <algorithm>
#include <cmath>

namespace argil::contact {
namespace {

using Cubic = std::array<double, 4>;  // Bernstein coefficients on [0, 1]

double evaluate(const Cubic& c, double t) {
  const double s = 1.0 - t;
  return s * s * (s * c[0] + 3.0 * t * c[1]) + t * t * (3.0 * s * c[2] + t * c[3]);
}

struct Roots {
  std::array<double, 5> t = {};
  int count = 0;
};

/// Root of a monotone piece whose ends differ in sign, by bisection to the last bit of t.
double bisect(const Cubic& c, double low, double high) {
  const bool low_is_negative = evaluate(c, low) < 0.0;
  for (int i = 0; i < 60 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    ((evaluate(c, middle) < 0.0) == low_is_negative ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Ends of the pieces on which the cubic is monotone: 0, the roots of its derivative inside (0, 1), 1.
Roots find_monotone_pieces(const Cubic& c) {
  Roots pieces;
  pieces.t[static_cast<std::size_t>(pieces.count++)] = 0.0;
  // derivative/3 = d0 (1−t)² + 2 d1 t(1−t) + d2 t²
  const double d0 = c[1] - c[0];
  const double d1 = c[2] - c[1];
  const double d2 = c[3] - c[2];
  const double a = d0 - 2.0 * d1 + d2;
  const double b = d1 - d0;
  const double disc = b * b - a * d0;
  if (disc > 0.0) {
    const double q = -(b + std::copysign(std::sqrt(disc), b));
    std::array<double, 2> r = {q != 0.0 ? d0 / q : -1.0, a != 0.0 ? q / a : -1.0};
    if (r[0] > r[1]) std::swap(r[0], r[1]);
    for (const double t : r)
      if (t > 0.0 && t < 1.0) pieces.t[static_cast<std::size_t>(pieces.count++)] = t;
  }
  pieces.t[static_cast<std::size_t>(pieces.count++)] = 1.0;
  return pieces;
}

/// What eqs. 7 and 8 integrate: n nᵀ(p−q), n the unit normal. The normal before it is made a unit is
/// quadratic in time (README), p−q between the features' first points linear; for edges nᵀ(p−q) does not
/// depend on where along them p and q lie.
struct DepthVector {
  Vec3 normal_t0, normal_middle, normal_t1;  ///< Bernstein coefficients
  Vec3 offset_t0, offset_t1;

  DepthVector(PairKind kind, const PairPath& path) {
    const std::array<Vec3, 3> n = compute_normals(kind, path);
    normal_t0 = n[0];
    normal_middle = n[1];
    normal_t1 = n[2];
    const std::size_t other = kind == PairKind::vertex_face ? 1 : 2;
    offset_t0 = path.t0[0] - path.t0[other];
    offset_t1 = path.t1[0] - path.t1[other];
  }

  Vec3 at(double t) const {
    const double s = 1.0 - t;
    const Vec3 n = s * s * normal_t0 + 2.0 * s * t * normal_middle + t * t * normal_t1;
    const double squared = n.squaredNorm();
    if (!(squared > 0.0)) return Vec3::Zero();
    return (n.dot(s * offset_t0 + t * offset_t1) / squared) * n;
  }
};

/// Five-point Gauss–Legendre rule on [a, b], halved until the three-point rule agrees to 1e-8. The errors go
/// with the sixth and the tenth power of the interval, so that the better one is then exact to some 1e-13; a
/// normal that does not turn needs no halving.
Vec3 integrate(const DepthVector& f, double a, double b, int halvings) {
  constexpr std::array<double, 2> node = {0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> weight = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  constexpr double kThreeNode = 0.7745966692414834;
  constexpr double kAgreement = 1e-8;
  constexpr double kRounding = 1e-14;  // of the depth, which may be far less than the offset
  const double middle = 0.5 * (a + b);
  const double half = 0.5 * (b - a);
  const Vec3 centre = f.at(middle);
  Vec3 five = weight[0] * centre;
  for (std::size_t k = 0; k < 2; ++k)
    five += weight[k + 1] * (f.at(middle - half * node[k]) + f.at(middle + half * node[k]));
  const Vec3 three =
      (8.0 * centre + 5.0 * (f.at(middle - half * kThreeNode) + f.at(middle + half * kThreeNode))) / 9.0;
  const double rounding = kRounding * std::max(f.offset_t0.norm(), f.offset_t1.norm());
  if (halvings == 0 || (five - three).norm() <= kAgreement * five.norm() + rounding) return half * five;
  return integrate(f, a, middle, halvings - 1) + integrate(f, middle, b, halvings - 1);
}

std::array<double, 4> compute_weights(PairKind kind, const std::array<Vec3, 4>& p) {
  if (kind == PairKind::vertex_face) {
    Vec3 b = compute_barycentric(p[0], p[1], p[2], p[3]).cwiseMax(0.0);
    b /= b.sum();
    return {1.0, b(0), b(1), b(2)};
  }
  const Eigen::Vector2d s = compute_line_parameters(p).cwiseMax(0.0).cwiseMin(1.0);
  return {1.0 - s(0), s(0), 1.0 - s(1), s(1)};
}

bool crosses_within(PairKind kind, const std::array<Vec3, 4>& p) {
  if (kind == PairKind::vertex_face)
    return compute_barycentric(p[0], p[1], p[2], p[3]).minCoeff() >= -kInsideMargin;
  const Eigen::Vector2d s = compute_line_parameters(p);
  return s.minCoeff() >= -kInsideMargin && s.maxCoeff() <= 1.0 + kInsideMargin;
}

/// Are the edges parallel, and apart? The coplanarity then vanishes with their common normal, and nothing
/// meets.
bool are_parallel_and_apart(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[3] - p[2];
  const Vec3 w = p[2] - p[0];
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  if (aa * bb - ab * ab > kParallel * aa * bb) return false;
  const double begin = w.dot(a);  // of b along a, where a goes from 0 to aa
  const double end = begin + ab;
  const double margin = kInsideMargin * aa;
  if (std::max(begin, end) < -margin || std::min(begin, end) > aa + margin) return true;
  const double distance = (w - (begin / aa) * a).norm();
  return distance > kInsideMargin * std::sqrt(std::max(aa, bb));
}

/// Which way the edges face each other before the first crossing: so that the start lies inside or outside.
double find_orientation(const PairPath& path, const Cubic& c, bool inside_at_start) {
  const double before = std::abs(c[0]) > coplanarity_error_bound(path) ? c[0] : -evaluate(c, 1e-3);
  return (before > 0.0) == inside_at_start ? -1.0 : 1.0;
}

/// What happens to a pair along t: intervals and weights, without the integral.
class IntervalWalk {
 public:
  /// `changes_sides`: edges whose lines cross beyond an end have passed each other without meeting, so that
  /// the way back may be an entry.
  IntervalWalk(PairKind kind, const PairPath& path, double orientation, bool changes_sides)
      : m_kind(kind), m_path(path), m_changes_sides(changes_sides), m_orientation(orientation) {
    m_penalty.orientation = orientation;
  }
  void open(double t) {
    if (m_penalty.num_intervals == 0) m_penalty.weights = compute_weights(m_kind, interpolate(m_path, t));
    m_penalty.intervals[static_cast<std::size_t>(m_penalty.num_intervals++)] = {t, 1.0};
    m_penalty.inside_at_end = true;
    m_penalty.orientation = m_orientation;
  }
  /// The coplanarity changes its sign at t. False where the two signs change their meaning there.
  bool cross(double t, bool inwards) {
    const std::array<Vec3, 4> p = interpolate(m_path, t);
    if (m_kind == PairKind::edge_edge && are_parallel_and_apart(p)) {
      m_orientation = -m_orientation;
      m_penalty.orientation = -m_penalty.orientation;
      return false;
    }
    if (m_penalty.inside_at_end && !inwards) close(t);
    if (m_penalty.inside_at_end || !inwards || m_penalty.num_intervals == 2) return true;
    if (crosses_within(m_kind, p))
      open(t);
    else if (m_changes_sides)
      m_orientation = -m_orientation;
    return m_penalty.inside_at_end || !m_changes_sides;
  }
  const Penalty& penalty() const { return m_penalty; }

 private:
  void close(double t) {
    m_penalty.intervals[static_cast<std::size_t>(m_penalty.num_intervals - 1)].end = t;
    m_penalty.inside_at_end = false;
  }
  PairKind m_kind;
  const PairPath& m_path;
  bool m_changes_sides;
  double m_orientation;
  Penalty m_penalty;
};

/// `c` is the coplanarity with the sign that makes outside positive; of edges where `orientation` is 0, that
/// sign is found.
Penalty find_intervals(PairKind kind, const PairPath& path, Cubic c, bool inside_at_start,
                       double orientation) {
  // A start that touches within rounding counts as outside, so that a motion inwards from there is an entry
  // at t = 0.
  const double touching = coplanarity_error_bound(path);
  const bool is_free = kind == PairKind::edge_edge && orientation == 0.0;
  if (is_free) orientation = find_orientation(path, c, inside_at_start);
  for (double& coefficient : c) coefficient *= orientation;

  IntervalWalk walk(kind, path, orientation, is_free);
  if (inside_at_start) walk.open(0.0);
  const Roots pieces = find_monotone_pieces(c);
  double side = 1.0;  // of c: outside is where side · c > 0
  double previous = inside_at_start ? -1.0 : (std::abs(c[0]) <= touching ? 1.0 : c[0]);
  for (int k = 1; k < pieces.count; ++k) {
    const double begin = pieces.t[static_cast<std::size_t>(k) - 1];
    const double end = pieces.t[static_cast<std::size_t>(k)];
    const double next = side * evaluate(c, end);
    if ((previous < 0.0) == (next < 0.0)) continue;
    // Where rounding or touching decided the sign of the start, the crossing is the start itself.
    const double start_value = side * evaluate(c, begin);
    const double root = (start_value < 0.0) == (next < 0.0) ? begin : bisect(c, begin, end);
    const bool keeps_sides = walk.cross(root, next < 0.0);
    previous = keeps_sides ? next : -next;
    if (!keeps_sides) side = -side;
  }
  return walk.penalty();
}

void integrate_intervals(PairKind kind, const PairPath& path, double until, Penalty& penalty) {
  if (until < 1.0) penalty.inside_at_end = false;
  if (penalty.num_intervals == 0) return;
  const DepthVector depth(kind, path);
  constexpr int kMaxHalvings = 12;
  for (int i = 0; i < penalty.num_intervals; ++i) {
    Interval& interval = penalty.intervals[static_cast<std::size_t>(i)];
    interval.end = std::max(interval.begin, std::min(interval.end, until));
    penalty.duration += interval.end - interval.begin;
    if (interval.end > interval.begin)
      penalty.integral += integrate(depth, interval.begin, interval.end, kMaxHalvings);
  }
}

}  // namespace

std::array<Vec3, 4> interpolate(const PairPath& path, double t) {
  std::array<Vec3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = path.t0[i] + t * (path.t1[i] - path.t0[i]);
  return p;
}

Vec3 compute_barycentric(const Vec3& p, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
  const Vec3 n = (f1 - f0).cross(f2 - f0);
  const double squared = n.squaredNorm();
  if (!(squared > 0.0)) return Vec3::Constant(1.0 / 3.0);
  const double b1 = n.dot((p - f0).cross(f2 - f0)) / squared;
  const double b2 = n.dot((f1 - f0).cross(p - f0)) / squared;
  return {1.0 - b1 - b2, b1, b2};
}

Eigen::Vector2d compute_line_parameters(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[3] - p[2];
  const Vec3 w = p[2] - p[0];
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  const double det = aa * bb - ab * ab;
  if (!(det > kParallel * aa * bb)) return {0.5, 0.5};
  const double wa = w.dot(a);
  const double wb = w.dot(b);
  return {(wa * bb - wb * ab) / det, (wa * ab - wb * aa) / det};
}

Penalty compute_vertex_face_penalty(const PairPath& path, bool inside_at_start, double until) {
  Penalty penalty = find_intervals(PairKind::vertex_face, path,
                                   compute_coplanarity(PairKind::vertex_face, path), inside_at_start, 1.0);
  integrate_intervals(PairKind::vertex_face, path, until, penalty);
  return penalty;
}

bool enters_face(const PairPath& path) {
  const Cubic c = compute_coplanarity(PairKind::vertex_face, path);
  return find_intervals(PairKind::vertex_face, path, c, false, 1.0).num_intervals > 0;
}

Penalty compute_edge_edge_penalty(const PairPath& path, bool inside_at_start, double orientation) {
  Penalty penalty = find_intervals(PairKind::edge_edge, path, compute_coplanarity(PairKind::edge_edge, path),
                                   inside_at_start, orientation);
  integrate_intervals(PairKind::edge_edge, path, 1.0, penalty);
  return penalty;
}

}  // namespace argil::contact
