// Detection: which vertices met faces and which edges met edges during the interval.

#include <algorithm>

#include "contact/detector.h"

namespace argil::contact {

void ContactDetector::Impl::find_entries(const Motion& motion) {
  tool_vertices.entries.clear();
  body_vertices.entries.clear();
  edge_entries.clear();
  Bounds tool_bounds;
  tool_bounds.include(Bounds{motion.tool_t0.rowwise().minCoeff(), motion.tool_t0.rowwise().maxCoeff()});
  tool_bounds.include(Bounds{motion.tool_t1.rowwise().minCoeff(), motion.tool_t1.rowwise().maxCoeff()});
  if (!body_tree) {
    body_tree = std::make_unique<BoundingTree>(motion.body_t0, body.triangles);
    body_candidates.reserve(static_cast<std::size_t>(body.triangles.cols()));
    tool_candidates.reserve(static_cast<std::size_t>(tool.triangles.cols()));
  }
  Bounds body_bounds;
  body_bounds.include(Bounds{motion.body_t0.rowwise().minCoeff(), motion.body_t0.rowwise().maxCoeff()});
  body_bounds.include(Bounds{motion.body_t1.rowwise().minCoeff(), motion.body_t1.rowwise().maxCoeff()});
  if (!tool_bounds.overlaps(body_bounds)) return;

  body_tree->refit(motion.body_t0, motion.body_t1);
  body_candidates.clear();
  body_tree->find_overlaps(tool_bounds, body_candidates);
  if (body_candidates.empty()) return;
  tool_tree.refit(motion.tool_t0, motion.tool_t1);
  for (const int body_face : body_candidates) {
    Bounds swept;
    for (int k = 0; k < 3; ++k) {
      swept.include(Vec3(motion.body_t0.col(body.triangles(k, body_face))));
      swept.include(Vec3(motion.body_t1.col(body.triangles(k, body_face))));
    }
    tool_candidates.clear();
    tool_tree.find_overlaps(swept, tool_candidates);
    for (const int tool_face : tool_candidates) test_triangles(body_face, tool_face, motion);
  }
  const auto earlier = [](const Entry& a, const Entry& b) {
    if (a.vertex != b.vertex) return a.vertex < b.vertex;
    return a.time != b.time ? a.time < b.time : a.face < b.face;
  };
  std::sort(tool_vertices.entries.begin(), tool_vertices.entries.end(), earlier);
  std::sort(body_vertices.entries.begin(), body_vertices.entries.end(), earlier);
  std::sort(edge_entries.begin(), edge_entries.end(),
            [](const EdgePair& a, const EdgePair& b) { return a.key() < b.key(); });
}

void ContactDetector::Impl::test_triangles(int body_face, int tool_face, const Motion& motion) {
  const Eigen::Vector3i b = body.triangles.col(body_face);
  const Eigen::Vector3i t = tool.triangles.col(tool_face);
  const auto test_vertex = [](VertexSide& side, int vertex, int face, const PairPath& path) {
    if (const auto time = find_time_of_impact(PairKind::vertex_face, path))
      side.entries.push_back({vertex, *time, face});
  };
  for (int k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(t(k));
    if (tool.vertex_owner[v] == tool_face && tool_vertices.face_of_vertex[v] < 0)
      test_vertex(
          tool_vertices, t(k), body_face,
          make_vertex_face_path(motion.tool_t0, motion.tool_t1, t(k), motion.body_t0, motion.body_t1, b));
    const auto w = static_cast<std::size_t>(b(k));
    if (body.vertex_owner[w] == body_face && body_vertices.face_of_vertex[w] < 0)
      test_vertex(
          body_vertices, b(k), tool_face,
          make_vertex_face_path(motion.body_t0, motion.body_t1, b(k), motion.tool_t0, motion.tool_t1, t));
  }
  for (int i = 0; i < 3; ++i) {
    const int tool_edge = tool.triangle_edges(i, tool_face);
    if (tool.edge_owner[static_cast<std::size_t>(tool_edge)] != tool_face) continue;
    for (int j = 0; j < 3; ++j) {
      const int body_edge = body.triangle_edges(j, body_face);
      if (body.edge_owner[static_cast<std::size_t>(body_edge)] != body_face) continue;
      const PairPath path = make_edge_path(motion, tool.edges.col(tool_edge), body.edges.col(body_edge));
      if (find_time_of_impact(PairKind::edge_edge, path)) edge_entries.push_back({tool_edge, body_edge, 0.0});
    }
  }
}

}  // namespace argil::contact
