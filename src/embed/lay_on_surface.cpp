#include "embed/lay_on_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "embed/sharp_edges.h"
#include "embed/skin_shape.h"
#include "embed/triangle_tree.h"
#include "mesh/quality.h"

namespace argil::embed {
namespace {

constexpr int kSweeps = 2;        // before vertices go to sharp edges, and after
constexpr int kTimesOnEdges = 2;  // that they do
constexpr int kSweepsOut = 2;
constexpr double kLeastShape = 0.25;    // mean ratio
constexpr double kLeastDegrees = 15.0;  // between faces, and from a straight angle
constexpr double kClose = 0.02;         // of an edge: nearer to the surface a vertex stays
constexpr int kHalvings = 3;            // of a way that tets do not bear

/// Of its mean ratio and angles over the least wanted.
double find_quality(const Points& vertices, const Eigen::Vector4i& t) {
  const std::array<Vec3, 4> x = {vertices.col(t(0)), vertices.col(t(1)), vertices.col(t(2)),
                                 vertices.col(t(3))};
  const mesh::DihedralAngles angles = mesh::compute_dihedral_angles(x);
  return std::min({mesh::compute_shape(x) / kLeastShape, angles.smallest_degrees / kLeastDegrees,
                   (180.0 - angles.largest_degrees) / kLeastDegrees});
}

class Mover {
 public:
  Mover(const mesh::Topology& topology, mesh::TetMesh& body) : m_topology(topology), m_body(body) {}

  /// Towards `place`, as far as the tets around bear it. Of one that gets no better for its shape, so far as
  /// the worst tet does not get worse.
  void move(int v, const Vec3& place, bool for_shape) {
    const Vec3 before = m_body.vertices.col(v);
    const double worst = find_worst(v);
    const double least = for_shape ? worst : std::min(worst, 1.0);
    double share = 1.0;
    for (int i = 0; i <= kHalvings; ++i, share *= 0.5) {
      m_body.vertices.col(v) = before + share * (place - before);
      const double found = find_worst(v, least);
      if (for_shape ? found > least : found >= least) return;
    }
    m_body.vertices.col(v) = before;
  }

  /// Mean of the corners of the tets around, and of their edges at v.
  Vec3 find_middle(int v, double& edge) const {
    Vec3 sum = Vec3::Zero();
    double length = 0.0;
    int count = 0;
    each_tet(v, [&](const auto& corners) {
      for (const int other : corners) {
        if (other == v) continue;
        sum += m_body.vertices.col(other);
        length += (m_body.vertices.col(other) - m_body.vertices.col(v)).norm();
        ++count;
      }
    });
    edge = length / std::max(count, 1);
    return sum / std::max(count, 1);
  }

 private:
  template <class Use>
  void each_tet(int v, Use use) const {
    const auto first = static_cast<std::size_t>(v);
    for (int c = m_topology.vertex_begin[first]; c < m_topology.vertex_begin[first + 1]; ++c)
      use(m_body.tets.col(m_topology.vertex_corners[static_cast<std::size_t>(c)] / 4));
  }
  /// Of mean ratios and angles over the least wanted; below `least`, that of any tet that is.
  double find_worst(int v, double least = -std::numeric_limits<double>::infinity()) const {
    double worst = std::numeric_limits<double>::infinity();
    each_tet(v, [&](const auto& t) {
      if (worst >= least) worst = std::min(worst, find_quality(m_body.vertices, t));
    });
    return worst;
  }

  const mesh::Topology& m_topology;
  mesh::TetMesh& m_body;
};

double find_longest_edge(const Points& x, const Eigen::Vector3i& corners) {
  const Vec3 a = x.col(corners(0)), b = x.col(corners(1)), c = x.col(corners(2));
  return std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
}

/// Of the triangles around each vertex [m]; 0: there are none.
Field find_longest_edges(const Triangles& triangles, const Points& x) {
  Field longest = Field::Zero(x.cols());
  for (const auto& corners : triangles.colwise())
    for (const int v : corners) longest(v) = std::max(longest(v), find_longest_edge(x, corners));
  return longest;
}

/// How far the surface lies outside the facets around each vertex, along their normal: Σ gap N a over Σ N a
/// of the points of a rule of degree 2 on each. Where the surface is not that of a facet's side, nothing
/// counts.
class Gaps {
 public:
  Gaps(const mesh::TriangleMesh& surface, const TriangleTree& tree, const Triangles& boundary,
       const Points& x)
      : m_gap(Field::Zero(x.cols())),
        m_area(m_gap),
        m_edge(find_longest_edges(boundary, x)),
        m_normal(Points::Zero(3, x.cols())) {
    for (const auto& corners : boundary.colwise()) {
      const Vec3 area = mesh::compute_area_vector(x, corners);
      for (const int v : corners) m_normal.col(v) += area;
      for (int k = 0; k < 3; ++k) {
        Vec3 weights = Vec3::Constant(1.0 / 6.0);
        weights(k) = 2.0 / 3.0;
        const Vec3 point =
            weights(0) * x.col(corners(0)) + weights(1) * x.col(corners(1)) + weights(2) * x.col(corners(2));
        const double gap = find_gap(surface, tree, point, area.normalized(), find_longest_edge(x, corners));
        for (Eigen::Index i = 0; i < 3; ++i) {
          m_gap(corners(i)) += gap * weights(i) * area.norm();
          m_area(corners(i)) += weights(i) * area.norm();
        }
      }
    }
  }
  Vec3 find_way(int v) const {
    constexpr double kMost = 0.2;  // of an edge
    if (!(m_area(v) > 0.0)) return Vec3::Zero();
    const double most = kMost * m_edge(v);
    return std::clamp(m_gap(v) / m_area(v), -most, most) * m_normal.col(v).normalized();
  }

 private:
  static double find_gap(const mesh::TriangleMesh& surface, const TriangleTree& tree, const Vec3& point,
                         const Vec3& normal, double edge) {
    constexpr double kSameSide = 0.3;  // cosine
    const TriangleTree::Nearest nearest = tree.find_nearest(point, edge);
    if (nearest.triangle < 0) return 0.0;
    const auto corners = surface.triangles.col(nearest.triangle);
    const Vec3 there = mesh::compute_area_vector(surface.vertices, corners);
    return there.normalized().dot(normal) > kSameSide ? (nearest.point - point).dot(normal) : 0.0;
  }

  Field m_gap, m_area;  // [m³], [m²]
  Field m_edge;         // longest [m]
  Points m_normal;
};

}  // namespace

namespace {

std::vector<char> find_outside(const mesh::Topology& topology, const mesh::TetMesh& body) {
  std::vector<char> is_outside(static_cast<std::size_t>(body.num_vertices()), 0);
  for (const int v : topology.boundary.reshaped()) is_outside[static_cast<std::size_t>(v)] = 1;
  return is_outside;
}

/// A vertex on its way to a place.
struct Way {
  double distance;  // over the edges there
  int v;
  Vec3 place;
};

void sort_nearest_first(std::vector<Way>& ways) {
  std::sort(ways.begin(), ways.end(),
            [](const Way& a, const Way& b) { return std::tie(a.distance, a.v) < std::tie(b.distance, b.v); });
}

/// Moves vertices of the boundary onto sharp edges of the surface that are near: to each corner the nearest
/// one, then others, the nearest first. Which of them have come there.
std::vector<char> lay_on_edges(const mesh::TriangleMesh& surface, const std::vector<char>& is_outside,
                               const mesh::TetMesh& body, Mover& mover) {
  constexpr double kNear = 0.8;  // of an edge
  std::vector<char> is_there(is_outside.size(), 0);
  const SharpEdges sharp = find_sharp_edges(surface);
  if (sharp.edges.cols() == 0) return is_there;
  Triangles lines(3, sharp.edges.cols());
  lines << sharp.edges, sharp.edges.row(1);
  const TriangleTree tree({surface.vertices, lines});
  std::vector<Way> ways;
  Field edge = Field::Zero(body.num_vertices());
  for (int v = 0; v < body.num_vertices(); ++v) {
    if (is_outside[static_cast<std::size_t>(v)] == 0) continue;
    mover.find_middle(v, edge(v));
    const TriangleTree::Nearest nearest = tree.find_nearest(body.vertices.col(v), kNear * edge(v));
    if (nearest.triangle >= 0) ways.push_back({nearest.distance / edge(v), v, nearest.point});
  }
  Triangles points(3, static_cast<Eigen::Index>(ways.size()));  // none is larger than its vertex
  for (std::size_t i = 0; i < ways.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)).setConstant(ways[i].v);
  const TriangleTree near({body.vertices, points});
  std::vector<Way> to_corners;
  for (const int corner : sharp.corners) {
    const Vec3 place = surface.vertices.col(corner);
    const TriangleTree::Nearest nearest = near.find_nearest(place, std::numeric_limits<double>::infinity());
    if (nearest.triangle < 0) continue;
    const int v = points(0, nearest.triangle);
    if (nearest.distance < edge(v)) to_corners.push_back({nearest.distance / edge(v), v, place});
  }
  sort_nearest_first(to_corners);
  sort_nearest_first(ways);
  to_corners.insert(to_corners.end(), ways.begin(), ways.end());
  for (const Way& way : to_corners) {
    char& is_now_there = is_there[static_cast<std::size_t>(way.v)];
    if (is_now_there != 0) continue;
    mover.move(way.v, way.place, false);
    is_now_there = (body.vertices.col(way.v) - way.place).norm() < kClose * edge(way.v) ? 1 : 0;
  }
  return is_there;
}

}  // namespace

void lay_on_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, bool bends_edges,
                    mesh::TetMesh& body) {
  const TriangleTree tree(surface);
  const std::vector<char> is_outside = find_outside(topology, body);
  Mover mover(topology, body);
  const auto sweep = [&] {
    for (int v = 0; v < body.num_vertices(); ++v) {
      double edge = 0.0;
      const Vec3 middle = mover.find_middle(v, edge);
      if (is_outside[static_cast<std::size_t>(v)] == 0) {
        mover.move(v, middle, true);
        continue;
      }
      const TriangleTree::Nearest nearest =
          tree.find_nearest(body.vertices.col(v), std::numeric_limits<double>::infinity());
      if (nearest.distance > kClose * edge) mover.move(v, nearest.point, false);
    }
  };
  std::vector<char> is_sharp;
  for (int i = 0; i < kTimesOnEdges; ++i) {
    for (int j = 0; j < kSweeps; ++j) sweep();
    is_sharp = lay_on_edges(surface, is_outside, body, mover);
  }
  for (int j = 0; j < kSweeps; ++j) sweep();
  if (bends_edges) return;
  // Facets whose corners lie on a round part cut it off: half of what they miss comes to lie on either side.
  for (int i = 0; i < kSweepsOut; ++i) {
    const Gaps gaps(surface, tree, topology.boundary, body.vertices);
    for (int v = 0; v < body.num_vertices(); ++v)
      if (is_outside[static_cast<std::size_t>(v)] != 0 && is_sharp[static_cast<std::size_t>(v)] == 0)
        mover.move(v, body.vertices.col(v) + gaps.find_way(v), false);
  }
}

namespace {

/// Ways inside become the means of those around, the boundary's stay.
void spread_ways(const mesh::Topology& topology, const mesh::TetMesh& body,
                 const std::vector<char>& is_outside, Points& ways) {
  constexpr int kTimes = 20;
  for (int i = 0; i < kTimes; ++i)
    for (int v = 0; v < body.num_vertices(); ++v) {
      const auto at = static_cast<std::size_t>(v);
      if (is_outside[at] != 0) continue;
      Vec3 sum = Vec3::Zero();
      for (int c = topology.vertex_begin[at]; c < topology.vertex_begin[at + 1]; ++c)
        for (const int other : body.tets.col(topology.vertex_corners[static_cast<std::size_t>(c)] / 4))
          if (other != v) sum += ways.col(other);
      ways.col(v) = sum / std::max(1, 3 * (topology.vertex_begin[at + 1] - topology.vertex_begin[at]));
    }
}

/// All go their ways at once; those of tets that would not bear it go half of theirs, and in the end none.
void move_together(Points ways, mesh::TetMesh& body) {
  const Points before = body.vertices;
  Field least(body.num_tets());
  for (int t = 0; t < body.num_tets(); ++t) least(t) = std::min(1.0, find_quality(before, body.tets.col(t)));
  constexpr int kTimes = 12;
  for (int i = 0; i <= kTimes; ++i) {
    body.vertices = before + ways;
    const Points tried = ways;
    bool is_borne = true;
    for (int t = 0; t < body.num_tets(); ++t) {
      if (!(find_quality(body.vertices, body.tets.col(t)) < least(t))) continue;
      is_borne = false;
      for (const int v : body.tets.col(t)) ways.col(v) = (2 * i < kTimes ? 0.5 : 0.0) * tried.col(v);
    }
    if (is_borne) return;
  }
  body.vertices = before;
}

}  // namespace

void draw_to_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, mesh::TetMesh& body) {
  constexpr int kTimes = 6;
  const TriangleTree tree(surface);
  const std::vector<char> is_outside = find_outside(topology, body);
  const Mover mover(topology, body);
  for (int i = 0; i < kTimes; ++i) {
    Points ways = Points::Zero(3, body.num_vertices());
    for (int v = 0; v < body.num_vertices(); ++v) {
      if (is_outside[static_cast<std::size_t>(v)] == 0) continue;
      double edge = 0.0;
      mover.find_middle(v, edge);
      const TriangleTree::Nearest nearest =
          tree.find_nearest(body.vertices.col(v), std::numeric_limits<double>::infinity());
      if (nearest.distance > kClose * edge) ways.col(v) = nearest.point - body.vertices.col(v);
    }
    if (ways.isZero(0.0)) return;
    spread_ways(topology, body, is_outside, ways);
    move_together(std::move(ways), body);
  }
}

void match_volume(double wanted, const mesh::Topology& topology, mesh::TetMesh& body) {
  constexpr int kTimes = 3;
  constexpr double kMost = 0.1;  // of the edges there
  constexpr double kCloseEnough = 1e-4;
  const Triangles& boundary = topology.boundary;
  Mover mover(topology, body);
  for (int i = 0; i < kTimes; ++i) {
    const double missing = wanted - compute_skin_volume({body.vertices, boundary});
    if (!(std::abs(missing) > kCloseEnough * wanted)) return;
    Points normal = Points::Zero(3, body.num_vertices());
    const Field edge = find_longest_edges(boundary, body.vertices);
    for (const auto& corners : boundary.colwise())
      for (const int v : corners) normal.col(v) += mesh::compute_area_vector(body.vertices, corners) / 3.0;
    const double gain =
        normal.colwise().norm() * edge.matrix();  // of the volume, where all move by an edge [m³]
    const double share = missing / gain;
    if (!(std::abs(share) < kMost)) return;
    for (int v = 0; v < body.num_vertices(); ++v)
      if (edge(v) > 0.0)
        mover.move(v, body.vertices.col(v) + share * edge(v) * normal.col(v).normalized(), false);
  }
}

}  // namespace argil::embed
