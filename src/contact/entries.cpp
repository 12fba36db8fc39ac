// Detection: which vertices met faces and which edges cross edges during the interval.

#include <algorithm>

#include "contact/detector.h"
#include "contact/four_pairs.h"

namespace argil::contact {
namespace {

/// An edge on its way.
struct EdgePath {
  std::array<Vec3, 2> t0, t1;

  EdgePath(const Points& x_t0, const Points& x_t1, const Eigen::Vector2i& v)
      : t0{x_t0.col(v(0)), x_t0.col(v(1))}, t1{x_t1.col(v(0)), x_t1.col(v(1))} {}
  mesh::Box swept() const {
    mesh::Box box;
    for (std::size_t k = 0; k < 2; ++k) {
      box.include(t0[k]);
      box.include(t1[k]);
    }
    return box;
  }
};

/// Is the surface concave at an edge, by more than rounding? Then no direction is in its normal cone.
bool is_concave(const SurfaceAt& surface, int edge) {
  const Vec3 n = compute_face_normal(surface, surface.features.edge_triangles(0, edge));
  const Vec3 across = surface.vertex(surface.features.edge_opposite(1, edge)) -
                      surface.vertex(surface.features.edges(0, edge));
  constexpr double kRounding = 1e-9;  // sine of the angle between the faces
  const double hfour = n.dot(across);
  return hfour > 0.0 && hfour * hfour > kRounding * kRounding * n.squaredNorm() * across.squaredNorm();
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

bool is_set(unsigned bits, std::size_t i) {
  return (bits >> i & 1U) != 0;
}

/// Of `items`, test(item, i) for those that look(four) does not rule out: bit i of what it returns stands for
/// item i of the four, of which the last fills what is left over.
template <class Look, class Test>
void each_four(const std::vector<int>& items, Look look, Test test) {
  for (std::size_t begin = 0; begin < items.size(); begin += FourPairs::kCount) {
    const std::size_t count = std::min<std::size_t>(FourPairs::kCount, items.size() - begin);
    std::array<int, FourPairs::kCount> four;
    for (std::size_t lane = 0; lane < FourPairs::kCount; ++lane)
      four[lane] = items[begin + std::min(lane, count - 1)];
    const unsigned stays = look(four);
    for (std::size_t lane = 0; lane < count; ++lane)
      if (is_set(stays, lane)) test(four[lane], lane);
  }
}

/// Row k of `corners` of each of four.
template <class Corners>
std::array<int, FourPairs::kCount> pick(const Corners& corners, Eigen::Index k,
                                        const std::array<int, FourPairs::kCount>& four) {
  std::array<int, FourPairs::kCount> vertices;
  for (std::size_t lane = 0; lane < FourPairs::kCount; ++lane) vertices[lane] = corners(k, four[lane]);
  return vertices;
}

/// By items, so that the room doubles when it is used up: a range takes just what it needs, again and again.
template <class Item>
void append(std::vector<Item>& to, const std::vector<Item>& from) {
  for (const Item& item : from) to.push_back(item);
}

void sort_entries(std::vector<Entry>& entries) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    if (a.vertex != b.vertex) return a.vertex < b.vertex;
    return a.time != b.time ? a.time < b.time : a.face < b.face;
  });
}

}  // namespace

void ContactDetector::Impl::find_entries(const Motion& motion, const mesh::Box& tool_bounds) {
  tool_vertices.entries.clear();
  body_vertices.entries.clear();
  edge_pairs.clear();
  for (const int face : body_candidates) near_faces[static_cast<std::size_t>(face)] = {};
  body_candidates.clear();
  const double separation = params.minimum_separation;
  workers.front().body_tree.find_overlaps(tool_bounds.grown(separation), motion.body_t0, motion.body_t1,
                                          body_candidates);
  // The tool stays within its sphere, whose centre never is farther from where it began than at the end.
  const double reach = tool_radius + separation + (centre_t1 - centre_t0).norm() * (1.0 + 1e-9);
  for (Worker& worker : workers) {
    worker.tool_entries.clear();
    worker.body_entries.clear();
    worker.edge_pairs.clear();
    worker.near_faces.clear();
  }
  each_item(body_candidates.size(),
            [&](Worker& worker, std::size_t i) { test_face(body_candidates[i], reach, motion, worker); });
  each_item(body_candidates.size(),
            [&](Worker& worker, std::size_t i) { test_edges(body_candidates[i], reach, motion, worker); });
  for (const Worker& worker : workers) {
    append(tool_vertices.entries, worker.tool_entries);
    append(body_vertices.entries, worker.body_entries);
    append(edge_pairs, worker.edge_pairs);
  }
  sort_entries(tool_vertices.entries);
  sort_entries(body_vertices.entries);
  std::sort(edge_pairs.begin(), edge_pairs.end(),
            [](const EdgePair& a, const EdgePair& b) { return a.key() < b.key(); });
  edge_pairs.erase(std::unique(edge_pairs.begin(), edge_pairs.end(),
                               [](const EdgePair& a, const EdgePair& b) { return a.key() == b.key(); }),
                   edge_pairs.end());
}

/// A body's face with its vertices against those of the tool's faces near it, which are kept for its edges.
void ContactDetector::Impl::test_face(int body_face, double reach, const Motion& motion, Worker& worker) {
  mesh::Box swept;
  for (int k = 0; k < 3; ++k) {
    swept.include(Vec3(motion.body_t0.col(body.triangles(k, body_face))));
    swept.include(Vec3(motion.body_t1.col(body.triangles(k, body_face))));
  }
  if (swept.squared_distance(centre_t0) > reach * reach) return;
  worker.tool_candidates.clear();
  worker.tool_tree.find_overlaps(swept.grown(params.minimum_separation), motion.tool_t0, motion.tool_t1,
                                 worker.tool_candidates);
  if (worker.tool_candidates.empty()) return;
  test_vertices(body_face, motion, worker);
  near_faces[static_cast<std::size_t>(body_face)] = {&worker, worker.near_faces.size(),
                                                     worker.tool_candidates.size()};
  worker.near_faces.insert(worker.near_faces.end(), worker.tool_candidates.begin(),
                           worker.tool_candidates.end());
}

/// Each vertex is tested with one of its faces, and none that is inside.
void ContactDetector::Impl::test_vertices(int body_face, const Motion& motion, Worker& worker) {
  const auto is_tested = [](const std::vector<int>& owner, const VertexSide& side, int v, int face) {
    const auto i = static_cast<std::size_t>(v);
    return owner[i] == face && side.face_of_vertex[i] < 0;
  };
  const auto test = [this](const VertexFaceMotion& m, int v, int face, std::vector<Entry>& entries) {
    if (const auto time =
            find_time_of_impact(PairKind::vertex_face, m.path(v, face), params.minimum_separation))
      entries.push_back({v, *time, face});
  };
  FourPairs pairs;

  std::vector<int>& tool_features = worker.tool_features;
  tool_features.clear();
  for (const int face : worker.tool_candidates)
    for (const int v : tool.triangles.col(face))
      if (is_tested(tool.vertex_owner, tool_vertices, v, face)) tool_features.push_back(v);
  if (!tool_features.empty())
    for (int k = 0; k < 3; ++k)
      set_points(pairs, k + 1, motion.body_t0, motion.body_t1, body.triangles(k, body_face));
  each_four(
      tool_features,
      [&](const std::array<int, FourPairs::kCount>& vertices) {
        set_points(pairs, 0, motion.tool_t0, motion.tool_t1, vertices);
        return find_coplanar(PairKind::vertex_face, pairs, params.minimum_separation);
      },
      [&](int v, std::size_t) { test(tool_vertex_motion(motion), v, body_face, worker.tool_entries); });

  for (const int w : body.triangles.col(body_face)) {
    if (!is_tested(body.vertex_owner, body_vertices, w, body_face)) continue;
    set_points(pairs, 0, motion.body_t0, motion.body_t1, w);
    each_four(
        worker.tool_candidates,
        [&](const std::array<int, FourPairs::kCount>& faces) {
          for (int k = 0; k < 3; ++k)
            set_points(pairs, k + 1, motion.tool_t0, motion.tool_t1, pick(tool.triangles, k, faces));
          return find_coplanar(PairKind::vertex_face, pairs, params.minimum_separation);
        },
        [&](int face, std::size_t) { test(body_vertex_motion(motion), w, face, worker.body_entries); });
  }
}

/// Edges of the tool's faces near any of these of the body, each once.
void ContactDetector::Impl::collect_tool_edges(std::array<int, 2> body_faces, Worker& worker) const {
  worker.tool_features.clear();
  worker.has_edge.clear();
  for (const int body_face : body_faces)
    for (const int face : near_faces[static_cast<std::size_t>(body_face)].list())
      for (const int edge : tool.triangle_edges.col(face))
        if (worker.has_edge.set(static_cast<std::size_t>(edge))) worker.tool_features.push_back(edge);
}

/// The edges of a body's face with those of the tool's faces near it. A pair that is already inside may have
/// only some of its faces near each other, so it is found by any of them. The owner of the body's edge tests
/// what is near either of its faces; the last face does so where nothing is near the owner. An edge that
/// stays farther from the tool's centre than `reach`, or is concave throughout, can bear no force.
void ContactDetector::Impl::test_edges(int body_face, double reach, const Motion& motion, Worker& worker) {
  const auto has_near = [this](int face) {
    return near_faces[static_cast<std::size_t>(face)].worker != nullptr;
  };
  if (!has_near(body_face)) return;
  const SurfaceAt body_t0{body, motion.body_t0, motion.body_t0},
      body_t1{body, motion.body_t1, motion.body_t1};
  const SurfaceAt tool_t0_at{tool, motion.tool_t0, motion.tool_t0};
  const SurfaceAt tool_t1_at{tool, motion.tool_t1, motion.tool_t1};
  FourPairs pairs;
  for (const int body_edge : body.triangle_edges.col(body_face)) {
    const int owner = body.edge_owner[static_cast<std::size_t>(body_edge)];
    const int last = body.edge_triangles(1, body_edge);
    if (body_face != owner && body_face == last && has_near(owner)) continue;
    if (is_concave(body_t0, body_edge) && is_concave(body_t1, body_edge)) continue;
    const EdgePath b(motion.body_t0, motion.body_t1, body.edges.col(body_edge));
    if (b.swept().squared_distance(centre_t0) > reach * reach) continue;
    collect_tool_edges({body_face, body_face == owner ? last : owner}, worker);
    for (int k = 0; k < 2; ++k)
      set_points(pairs, k + 2, motion.body_t0, motion.body_t1, body.edges(k, body_edge));
    unsigned alongside = 0, coplanar = 0;  // bits for four pairs: may they be crossed, may they meet
    const auto test = [&](int tool_edge, std::size_t i) {
      const EdgePath a(motion.tool_t0, motion.tool_t1, tool.edges.col(tool_edge));
      EdgePair pair{tool_edge, body_edge};
      if (is_set(alongside, i)) {
        pair.inside_t0 = is_crossed(a.t0, b.t0, tool_t0_at, tool_edge, body_t0, body_edge);
        pair.inside_t1 = is_crossed(a.t1, b.t1, tool_t1_at, tool_edge, body_t1, body_edge);
      }
      if (pair.inside_t0 || pair.inside_t1 ||
          (is_set(coplanar, i) &&
           find_time_of_impact(PairKind::edge_edge,
                               {{a.t0[0], a.t0[1], b.t0[0], b.t0[1]}, {a.t1[0], a.t1[1], b.t1[0], b.t1[1]}},
                               params.minimum_separation)))
        worker.edge_pairs.push_back(pair);
    };
    each_four(
        worker.tool_features,
        [&](const std::array<int, FourPairs::kCount>& edges) {
          for (int k = 0; k < 2; ++k)
            set_points(pairs, k, motion.tool_t0, motion.tool_t1, pick(tool.edges, k, edges));
          alongside = find_alongside(pairs);
          coplanar = find_coplanar(PairKind::edge_edge, pairs, params.minimum_separation);
          return alongside | coplanar;
        },
        test);
  }
}

}  // namespace argil::contact
