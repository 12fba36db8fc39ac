// Detection: which vertices met faces and which edges cross edges during the interval.

#include <algorithm>

#include "contact/detector.h"

namespace argil::contact {
namespace {

/// Do both parameters of compute_line_parameters lie in [0, 1]? Without its divisions.
bool are_nearest_within(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[3] - p[2];
  const Vec3 w = p[2] - p[0];
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  const double det = aa * bb - ab * ab;
  const double wa = w.dot(a);
  const double wb = w.dot(b);
  const double s = wa * bb - wb * ab;
  const double r = wa * ab - wb * aa;
  return (s >= 0.0 && s <= det && r >= 0.0 && r <= det) || !(det > kParallel * aa * bb);
}

/// Do the edges cross in penetration at one end of the interval? Both parameters lie in [0, 1], the common
/// normal points out of the body and into the tool, and along it the tool's edge lies deeper than the body's.
bool is_crossed(const std::array<Vec3, 4>& p, const SurfaceAt& tool, int tool_edge, const SurfaceAt& body,
                int body_edge) {
  if (!are_nearest_within(p)) return false;
  Vec3 n = (p[1] - p[0]).cross(p[3] - p[2]);
  if (n.dot(p[0] - p[2]) > 0.0) n = -n;  // now the tool's edge lies behind the body's along n
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
  body_tree->find_overlaps(tool_bounds, motion.body_t0, motion.body_t1, body_candidates);
  // The tool stays within its sphere, whose centre never is farther from where it began than at the end.
  const double reach = tool_radius + (centre_t1 - centre_t0).norm() * (1.0 + 1e-9);
  for (const int body_face : body_candidates) {
    Bounds swept;
    for (int k = 0; k < 3; ++k) {
      swept.include(Vec3(motion.body_t0.col(body.triangles(k, body_face))));
      swept.include(Vec3(motion.body_t1.col(body.triangles(k, body_face))));
    }
    if (swept.squared_distance(centre_t0) > reach * reach) continue;
    tool_candidates.clear();
    tool_tree.find_overlaps(swept, motion.tool_t0, motion.tool_t1, tool_candidates);
    for (const int tool_face : tool_candidates) {
      test_vertices(body_face, tool_face, motion);
      test_edges(body_face, tool_face, motion);
    }
  }
  sort_entries(tool_vertices.entries);
  sort_entries(body_vertices.entries);
  std::sort(edge_pairs.begin(), edge_pairs.end(),
            [](const EdgePair& a, const EdgePair& b) { return a.key() < b.key(); });
}

void ContactDetector::Impl::test_vertices(int body_face, int tool_face, const Motion& motion) {
  const auto test = [](const VertexFaceMotion& m, int v, int face) {
    if (const auto time = find_time_of_impact(PairKind::vertex_face, m.path(v, face)))
      m.side.entries.push_back({v, *time, face});
  };
  const VertexFaceMotion of_tool = tool_vertex_motion(motion);
  const VertexFaceMotion of_body = body_vertex_motion(motion);
  for (int k = 0; k < 3; ++k) {
    const int v = tool.triangles(k, tool_face);
    const auto i = static_cast<std::size_t>(v);
    if (tool.vertex_owner[i] == tool_face && tool_vertices.face_of_vertex[i] < 0) test(of_tool, v, body_face);
    const int w = body.triangles(k, body_face);
    const auto j = static_cast<std::size_t>(w);
    if (body.vertex_owner[j] == body_face && body_vertices.face_of_vertex[j] < 0) test(of_body, w, tool_face);
  }
}

void ContactDetector::Impl::test_edges(int body_face, int tool_face, const Motion& motion) {
  for (int i = 0; i < 3; ++i) {
    const int tool_edge = tool.triangle_edges(i, tool_face);
    if (tool.edge_owner[static_cast<std::size_t>(tool_edge)] != tool_face) continue;
    for (int j = 0; j < 3; ++j) {
      const int body_edge = body.triangle_edges(j, body_face);
      if (body.edge_owner[static_cast<std::size_t>(body_edge)] != body_face) continue;
      const PairPath path = make_edge_path(motion, tool.edges.col(tool_edge), body.edges.col(body_edge));
      EdgePair pair{tool_edge, body_edge};
      pair.inside_t0 = is_crossed(path.t0, {tool, motion.tool_t0, motion.tool_t0}, tool_edge,
                                  {body, motion.body_t0, motion.body_t0}, body_edge);
      pair.inside_t1 = is_crossed(path.t1, {tool, motion.tool_t1, motion.tool_t1}, tool_edge,
                                  {body, motion.body_t1, motion.body_t1}, body_edge);
      if (pair.inside_t0 || pair.inside_t1 || find_time_of_impact(PairKind::edge_edge, path))
        edge_pairs.push_back(pair);
    }
  }
}

}  // namespace argil::contact
