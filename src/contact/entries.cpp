// Detection: which vertices met faces and which edges cross edges during the interval.

#include <algorithm>

#include "contact/detector.h"

namespace argil::contact {
namespace {

/// An edge on its way.
struct EdgePath {
  std::array<Vec3, 2> t0, t1;

  EdgePath(const Points& x_t0, const Points& x_t1, const Eigen::Vector2i& v)
      : t0{x_t0.col(v(0)), x_t0.col(v(1))}, t1{x_t1.col(v(0)), x_t1.col(v(1))} {}
  Bounds swept() const {
    Bounds box;
    for (std::size_t k = 0; k < 2; ++k) {
      box.include(t0[k]);
      box.include(t1[k]);
    }
    return box;
  }
};

/// Do the edge's box and `other`, grown by `separation`, overlap? Axis by axis: most are told apart by the
/// first.
bool may_meet(const EdgePath& edge, const Bounds& other, double separation) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({edge.t0[0](k), edge.t0[1](k), edge.t1[0](k), edge.t1[1](k)});
    if (low - separation > other.high(k) || high + separation < other.low(k)) return false;
  }
  return true;
}

/// Is the surface concave at an edge, by more than rounding? Then no direction is in its normal cone.
bool is_concave(const SurfaceAt& surface, int edge) {
  const Vec3 n = compute_face_normal(surface, surface.features.edge_triangles(0, edge));
  const Vec3 across = surface.vertex(surface.features.edge_opposite(1, edge)) -
                      surface.vertex(surface.features.edges(0, edge));
  constexpr double kRounding = 1e-9;  // sine of the angle between the faces
  const double height = n.dot(across);
  return height > 0.0 && height * height > kRounding * kRounding * n.squaredNorm() * across.squaredNorm();
}

/// Do the edges cross in penetration at one end of the interval? Both parameters of compute_line_parameters
/// lie in [0, 1] (here without its divisions), the common normal points out of the body and into the tool,
/// and along it the tool's edge lies deeper than the body's.
bool is_crossed(const std::array<Vec3, 2>& tool_at, const std::array<Vec3, 2>& body_at, const SurfaceAt& tool,
                int tool_edge, const SurfaceAt& body, int body_edge) {
  const Vec3 a = tool_at[1] - tool_at[0];
  const Vec3 b = body_at[1] - body_at[0];
  const Vec3 w = body_at[0] - tool_at[0];
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  const double det = aa * bb - ab * ab;
  const double wa = w.dot(a);
  const double wb = w.dot(b);
  const double s = wa * bb - wb * ab;
  const double r = wa * ab - wb * aa;
  const bool is_within = s >= 0.0 && s <= det && r >= 0.0 && r <= det;
  if (!is_within && det > kParallel * aa * bb) return false;
  Vec3 n = a.cross(b);
  if (n.dot(w) < 0.0) n = -n;  // now the tool's edge lies behind the body's along n
  return is_in_normal_cone(body, body_edge, n) && is_in_normal_cone(tool, tool_edge, -n);
}

void sort_entries(std::vector<Entry>& entries) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    if (a.vertex != b.vertex) return a.vertex < b.vertex;
    return a.time != b.time ? a.time < b.time : a.face < b.face;
  });
}

}  // namespace

void ContactDetector::Impl::find_entries(const Motion& motion, const Bounds& tool_bounds) {
  tool_vertices.entries.clear();
  body_vertices.entries.clear();
  edge_pairs.clear();
  body_candidates.clear();
  const double separation = params.minimum_separation;
  body_tree->find_overlaps(tool_bounds.grown(separation), motion.body_t0, motion.body_t1, body_candidates);
  // The tool stays within its sphere, whose centre never is farther from where it began than at the end.
  const double reach = tool_radius + separation + (centre_t1 - centre_t0).norm() * (1.0 + 1e-9);
  for (const int body_face : body_candidates) {
    Bounds swept;
    for (int k = 0; k < 3; ++k) {
      swept.include(Vec3(motion.body_t0.col(body.triangles(k, body_face))));
      swept.include(Vec3(motion.body_t1.col(body.triangles(k, body_face))));
    }
    if (swept.squared_distance(centre_t0) > reach * reach) continue;
    swept = swept.grown(separation);
    tool_candidates.clear();
    tool_tree.find_overlaps(swept, motion.tool_t0, motion.tool_t1, tool_candidates);
    for (const int tool_face : tool_candidates) test_vertices(body_face, tool_face, swept, motion);
    if (tool_candidates.empty()) continue;
    for (const int body_edge : body.triangle_edges.col(body_face))
      if (body.edge_owner[static_cast<std::size_t>(body_edge)] == body_face)
        test_edges(body_edge, reach, motion);
  }
  sort_entries(tool_vertices.entries);
  sort_entries(body_vertices.entries);
  std::sort(edge_pairs.begin(), edge_pairs.end(),
            [](const EdgePair& a, const EdgePair& b) { return a.key() < b.key(); });
}

void ContactDetector::Impl::test_vertices(int body_face, int tool_face, const Bounds& swept_body,
                                          const Motion& motion) {
  const auto test = [this](const VertexFaceMotion& m, int v, int face) {
    if (const auto time =
            find_time_of_impact(PairKind::vertex_face, m.path(v, face), params.minimum_separation))
      m.side.entries.push_back({v, *time, face});
  };
  for (int k = 0; k < 3; ++k) {
    const int v = tool.triangles(k, tool_face);
    const auto i = static_cast<std::size_t>(v);
    if (tool.vertex_owner[i] == tool_face && tool_vertices.face_of_vertex[i] < 0) {
      Bounds way;
      way.include(Vec3(motion.tool_t0.col(v)));
      way.include(Vec3(motion.tool_t1.col(v)));
      if (way.overlaps(swept_body, 0.0)) test(tool_vertex_motion(motion), v, body_face);
    }
    const int w = body.triangles(k, body_face);
    const auto j = static_cast<std::size_t>(w);
    if (body.vertex_owner[j] == body_face && body_vertices.face_of_vertex[j] < 0)
      test(body_vertex_motion(motion), w, tool_face);
  }
}

/// An edge of the body against those of the present tool candidates. One that stays farther from the tool's
/// centre than `reach`, or is concave throughout, can bear no force.
void ContactDetector::Impl::test_edges(int body_edge, double reach, const Motion& motion) {
  const SurfaceAt body_t0{body, motion.body_t0, motion.body_t0},
      body_t1{body, motion.body_t1, motion.body_t1};
  if (is_concave(body_t0, body_edge) && is_concave(body_t1, body_edge)) return;
  const EdgePath b(motion.body_t0, motion.body_t1, body.edges.col(body_edge));
  const Bounds swept = b.swept();
  if (swept.squared_distance(centre_t0) > reach * reach) return;
  const SurfaceAt tool_t0_at{tool, motion.tool_t0, motion.tool_t0};
  const SurfaceAt tool_t1_at{tool, motion.tool_t1, motion.tool_t1};
  for (const int tool_face : tool_candidates)
    for (const int tool_edge : tool.triangle_edges.col(tool_face)) {
      if (tool.edge_owner[static_cast<std::size_t>(tool_edge)] != tool_face) continue;
      const EdgePath a(motion.tool_t0, motion.tool_t1, tool.edges.col(tool_edge));
      EdgePair pair{tool_edge, body_edge};
      pair.inside_t0 = is_crossed(a.t0, b.t0, tool_t0_at, tool_edge, body_t0, body_edge);
      pair.inside_t1 = is_crossed(a.t1, b.t1, tool_t1_at, tool_edge, body_t1, body_edge);
      bool is_hit = pair.inside_t0 || pair.inside_t1;
      if (!is_hit && may_meet(a, swept, params.minimum_separation))
        is_hit =
            find_time_of_impact(PairKind::edge_edge,
                                {{a.t0[0], a.t0[1], b.t0[0], b.t0[1]}, {a.t1[0], a.t1[1], b.t1[0], b.t1[1]}},
                                params.minimum_separation)
                .has_value();
      if (is_hit) edge_pairs.push_back(pair);
    }
}

}  // namespace argil::contact
