// Forces: penalty integrals of every pair in penetration, and what is carried to the next interval.

#include "contact/contact.h"

#include <algorithm>
#include <cmath>

#include "contact/detector.h"

namespace argil::contact {
namespace {

// An edge-edge contact fades out over this share of an edge's length beyond its end, and between one and two
// times this sine² of the angle between the edges: past these the infinite lines still overlap but the edges
// no longer do.
constexpr double kEndFade = 0.25;
constexpr double kParallelSine2 = 1e-3;

double compute_edge_fade(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[3] - p[2];
  const double sine2 = a.cross(b).squaredNorm() / (a.squaredNorm() * b.squaredNorm());
  const Eigen::Vector2d s = compute_line_parameters(p);
  const double beyond = std::max({-s.minCoeff(), s.maxCoeff() - 1.0, 0.0});
  return std::clamp(1.0 - beyond / kEndFade, 0.0, 1.0) * std::clamp(sine2 / kParallelSine2 - 1.0, 0.0, 1.0);
}

/// Height of p over the plane of face f [m]; negative inside.
double compute_height(const Points& x, const Triangles& triangles, int f, const Vec3& p) {
  return compute_face_normal(x, triangles, f).normalized().dot(p - x.col(triangles(0, f)));
}

/// Goes through the vertices that were inside and those that entered, asks `press` for the penalty of each on
/// its face, and carries those that end behind the face nearest to them then.
template <class Press>
void press_vertices(VertexSide& side, const SurfaceFeatures& faces, const Points& vertex_t1,
                    const Points& face_t1, Press press) {
  side.inside_next.clear();
  const auto carry = [&](int v, int face) {
    // A vertex that slid sideways is handed to the face it is nearest to; it is out when it is in front of
    // that.
    face = walk_to_nearest(faces, face_t1, vertex_t1.col(v), face);
    const double outside = compute_height(face_t1, faces.triangles, face, vertex_t1.col(v));
    const bool inside = outside < 0.0;
    side.face_of_vertex[static_cast<std::size_t>(v)] = inside ? face : -1;
    side.depth[static_cast<std::size_t>(v)] = inside ? -outside : 0.0;
    if (inside) side.inside_next.push_back(v);
  };
  auto entry = side.entries.cbegin();
  auto old = side.inside.cbegin();
  while (old != side.inside.cend() || entry != side.entries.cend()) {
    if (entry == side.entries.cend() || (old != side.inside.cend() && *old < entry->vertex)) {
      const int v = *old++;
      const int face = side.face_of_vertex[static_cast<std::size_t>(v)];
      press(v, face, true);
      carry(v, face);
      continue;
    }
    // Of the faces the vertex met, the earliest through which it really went in takes it.
    const int v = entry->vertex;
    const int first_face = entry->face;
    bool pressed = false;
    for (; entry != side.entries.cend() && entry->vertex == v; ++entry) {
      if (pressed || !press(v, entry->face, false)) continue;
      pressed = true;
      carry(v, entry->face);
    }
    // Met a face within the margin of detection and lies behind it, though no crossing was seen: still
    // carried.
    if (!pressed && compute_height(face_t1, faces.triangles, first_face, vertex_t1.col(v)) < 0.0)
      carry(v, first_face);
  }
  std::swap(side.inside, side.inside_next);
}

/// Counts crossings of a ray, in a direction that no mesh is aligned with.
bool contains_point(const Points& x, const Triangles& triangles, const Vec3& p) {
  const Vec3 direction = Vec3(0.5377, 0.3142, 0.7828).normalized();
  bool inside = false;
  for (int f = 0; f < triangles.cols(); ++f) {
    const Vec3 a = x.col(triangles(0, f));
    const Vec3 n = compute_face_normal(x, triangles, f);
    const double slope = n.dot(direction);
    if (slope == 0.0) continue;
    const double t = n.dot(a - p) / slope;
    if (t > 0.0 && compute_barycentric(p + t * direction, a, x.col(triangles(1, f)), x.col(triangles(2, f)))
                           .minCoeff() >= 0.0)
      inside = !inside;
  }
  return inside;
}

/// Does the edge of one surface pierce a face of the other?
bool pierces(const Points& edge_x, const Eigen::Vector2i& e, const Points& face_x, const Triangles& faces,
             int f) {
  const Vec3 p = edge_x.col(e(0));
  const Vec3 q = edge_x.col(e(1));
  const double dp = compute_height(face_x, faces, f, p);
  const double dq = compute_height(face_x, faces, f, q);
  if ((dp > 0.0) == (dq > 0.0)) return false;
  return compute_barycentric(p + dp / (dp - dq) * (q - p), face_x.col(faces(0, f)), face_x.col(faces(1, f)),
                             face_x.col(faces(2, f)))
             .minCoeff() >= 0.0;
}

}  // namespace

void Contacts::clear() {
  contacts.clear();
  touched_triangle.clear();
  touched_area.clear();
  force_on_tool.setZero();
  torque_on_tool.setZero();
}

ContactDetector::Impl::Impl(const Triangles& surface, int num_body_vertices,
                            const mesh::TriangleMesh& tool_mesh, const ContactParams& p)
    : params(p),
      body(surface, num_body_vertices),
      tool(tool_mesh.triangles, tool_mesh.num_vertices()),
      tool_rest(tool_mesh.vertices),
      tool_vertex_area(Points::Zero(3, tool_mesh.num_vertices())),
      tool_t0(tool_mesh.vertices),
      tool_t1(tool_mesh.vertices),
      tool_tree(tool_mesh.vertices, tool_mesh.triangles),
      touched_area(Field::Zero(surface.cols())) {
  tool_vertices.depth.assign(static_cast<std::size_t>(tool_mesh.num_vertices()), 0.0);
  body_vertices.depth.assign(static_cast<std::size_t>(num_body_vertices), 0.0);
  tool_vertices.face_of_vertex.assign(static_cast<std::size_t>(tool_mesh.num_vertices()), -1);
  body_vertices.face_of_vertex.assign(static_cast<std::size_t>(num_body_vertices), -1);
  for (int f = 0; f < tool_mesh.num_triangles(); ++f)
    for (int k = 0; k < 3; ++k)
      tool_vertex_area.col(tool_mesh.triangles(k, f)) +=
          compute_face_normal(tool_rest, tool_mesh.triangles, f) / 6.0;
}

void ContactDetector::Impl::place_tool(const Pose& pose, Points& out) const {
  out.noalias() = pose.orientation.toRotationMatrix() * tool_rest;
  out.colwise() += pose.position;
}

ContactDetector::ContactDetector(const Triangles& surface, int num_body_vertices,
                                 const mesh::TriangleMesh& tool, const ContactParams& params)
    : m_impl(std::make_unique<Impl>(surface, num_body_vertices, tool, params)) {}
ContactDetector::~ContactDetector() = default;
ContactDetector::ContactDetector(ContactDetector&&) noexcept = default;
ContactDetector& ContactDetector::operator=(ContactDetector&&) noexcept = default;

void ContactDetector::find_contacts(const Points& x_t0, const Points& x_t1, const Pose& pose_t0,
                                    const Pose& pose_t1, Contacts& contacts) {
  Impl& impl = *m_impl;
  contacts.clear();
  impl.place_tool(pose_t0, impl.tool_t0);
  impl.place_tool(pose_t1, impl.tool_t1);
  const Motion motion{x_t0, x_t1, impl.tool_t0, impl.tool_t1};
  impl.find_entries(motion);
  impl.press_tool_vertices(motion, contacts);
  impl.press_body_vertices(motion, contacts);
  impl.press_edges(motion, contacts);
  impl.measure_touched(motion, pose_t1, contacts);
  for (const Contact& c : contacts.contacts) {
    contacts.force_on_tool -= c.force;
    contacts.torque_on_tool -= (c.point - pose_t1.position).cross(c.force);
  }
}

/// Eq. 7 with the body's face: the force on the body is k·∫ nᵀ(p−q) n dt, shared by the face's corners.
void ContactDetector::Impl::press_tool_vertices(const Motion& m, Contacts& out) {
  press_vertices(tool_vertices, body, m.tool_t1, m.body_t1, [&](int v, int face, bool inside) {
    const Eigen::Vector3i f = body.triangles.col(face);
    const PairPath path = make_vertex_face_path(m.tool_t0, m.tool_t1, v, m.body_t0, m.body_t1, f);
    const Penalty penalty = compute_vertex_face_penalty(path, inside);
    const double depth = penalty.integral.norm();
    if (!(depth > 0.0)) return penalty.num_intervals > 0;
    Contact c;
    c.vertex = {f(0), f(1), f(2)};
    c.weight = {penalty.weights[1], penalty.weights[2], penalty.weights[3]};
    c.normal = penalty.integral / depth;
    c.force = params.vertex_face_stiffness * penalty.integral;
    c.stiffness = params.vertex_face_stiffness * penalty.duration;
    c.point = c.weight[0] * path.t1[1] + c.weight[1] * path.t1[2] + c.weight[2] * path.t1[3];
    out.contacts.push_back(c);
    return true;
  });
}

/// Eq. 7 with the tool's face: the vertex is the body's, so the sign is reversed.
void ContactDetector::Impl::press_body_vertices(const Motion& m, Contacts& out) {
  press_vertices(body_vertices, tool, m.body_t1, m.tool_t1, [&](int v, int face, bool inside) {
    const PairPath path =
        make_vertex_face_path(m.body_t0, m.body_t1, v, m.tool_t0, m.tool_t1, tool.triangles.col(face));
    const Penalty penalty = compute_vertex_face_penalty(path, inside);
    const double depth = penalty.integral.norm();
    if (!(depth > 0.0)) return penalty.num_intervals > 0;
    Contact c;
    c.vertex = {v, -1, -1};
    c.weight = {1.0, 0.0, 0.0};
    c.normal = -penalty.integral / depth;
    c.force = -params.vertex_face_stiffness * penalty.integral;
    c.stiffness = params.vertex_face_stiffness * penalty.duration;
    c.point = path.t1[0];
    out.contacts.push_back(c);
    return true;
  });
}

/// Share of an edge pair's depth that its end vertices do not press already: 1 while none of them is inside,
/// 0 once one is as deep as the pair. Without it one dent would count at the vertices and again at every
/// crossing of edges between them.
double ContactDetector::Impl::compute_uncovered_share(const EdgePair& pair, double depth) const {
  double covered = 0.0;
  for (int k = 0; k < 2; ++k) {
    covered = std::max(covered, tool_vertices.depth[static_cast<std::size_t>(tool.edges(k, pair.tool_edge))]);
    covered = std::max(covered, body_vertices.depth[static_cast<std::size_t>(body.edges(k, pair.body_edge))]);
  }
  return std::max(0.0, 1.0 - covered / depth);
}

/// Eq. 8 with p on the tool's edge and q on the body's. A pair is admitted when its normal points out of the
/// body and into the tool: edges that part after having come alongside each other cross too, but the other
/// way round.
void ContactDetector::Impl::press_edges(const Motion& m, Contacts& out) {
  edge_pairs_next.clear();
  auto old = edge_pairs.cbegin();
  auto entry = edge_entries.cbegin();
  while (old != edge_pairs.cend() || entry != edge_entries.cend()) {
    const bool is_old =
        entry == edge_entries.cend() || (old != edge_pairs.cend() && old->key() <= entry->key());
    EdgePair pair = is_old ? *old : *entry;
    if (is_old && entry != edge_entries.cend() && entry->key() == old->key()) ++entry;
    is_old ? ++old : ++entry;
    const Eigen::Vector2i b = body.edges.col(pair.body_edge);
    const PairPath path = make_edge_path(m, tool.edges.col(pair.tool_edge), b);
    const Penalty penalty = compute_edge_edge_penalty(path, is_old, pair.orientation);
    if (penalty.num_intervals == 0) continue;
    pair.orientation = penalty.orientation;
    const Vec3 normal = penalty.orientation * (path.t1[1] - path.t1[0]).cross(path.t1[3] - path.t1[2]);
    if (!is_old && !(normal.dot(compute_edge_normal(m.body_t1, body, pair.body_edge)) > 0.0 &&
                     normal.dot(compute_edge_normal(m.tool_t1, tool, pair.tool_edge)) < 0.0))
      continue;
    const double end_fade = compute_edge_fade(path.t1);
    if (!(end_fade > 0.0)) continue;
    if (penalty.inside_at_end) edge_pairs_next.push_back(pair);
    const double depth = penalty.integral.norm();
    const double fade = end_fade * compute_uncovered_share(pair, depth / penalty.duration);
    if (!(fade * depth > 0.0)) continue;
    Contact c;
    c.vertex = {b(0), b(1), -1};
    c.weight = {penalty.weights[2], penalty.weights[3], 0.0};
    c.normal = penalty.integral / depth;
    c.force = fade * params.edge_edge_stiffness * penalty.integral;
    c.stiffness = fade * params.edge_edge_stiffness * penalty.duration;
    c.point = c.weight[0] * path.t1[2] + c.weight[1] * path.t1[3];
    out.contacts.push_back(c);
  }
  std::swap(edge_pairs, edge_pairs_next);
}

/// Touched area of each body triangle. Tool vertices behind it bring their area projected on it; body
/// vertices inside the tool bring a third of their triangles. Either is blind where its own mesh is coarse:
/// the one with more vertices inside counts.
void ContactDetector::Impl::measure_touched(const Motion& m, const Pose& pose_t1, Contacts& out) {
  touched.clear();
  if (tool_vertices.inside.size() >= body_vertices.inside.size()) {
    for (const int v : tool_vertices.inside) {
      const int f = tool_vertices.face_of_vertex[static_cast<std::size_t>(v)];
      const Vec3 area = pose_t1.orientation * Vec3(tool_vertex_area.col(v));
      touched_area(f) +=
          std::max(0.0, -area.dot(compute_face_normal(m.body_t1, body.triangles, f).normalized()));
      touched.push_back(f);
    }
  } else {
    for (const int v : body_vertices.inside) {
      const auto add = [&](int f) {
        if ((body.triangles.col(f).array() != v).all()) return;
        touched_area(f) += compute_face_normal(m.body_t1, body.triangles, f).norm() / 6.0;
        touched.push_back(f);
      };
      const auto owner = static_cast<std::size_t>(body.vertex_owner[static_cast<std::size_t>(v)]);
      add(static_cast<int>(owner));
      for (int i = body.ring_begin[owner]; i < body.ring_begin[owner + 1]; ++i)
        add(body.ring[static_cast<std::size_t>(i)]);
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (const int f : touched) {
    if (touched_area(f) > 0.0) {
      out.touched_triangle.push_back(f);
      out.touched_area.push_back(touched_area(f));
    }
    touched_area(f) = 0.0;
  }
}

bool ContactDetector::overlaps(const Points& x, const Pose& pose) const {
  const Impl& impl = *m_impl;
  Points placed;
  impl.place_tool(pose, placed);
  const BoundingTree body_tree(x, impl.body.triangles);
  Bounds bounds;
  bounds.include(Bounds{placed.rowwise().minCoeff(), placed.rowwise().maxCoeff()});
  std::vector<int> near;
  body_tree.find_overlaps(bounds, near);
  if (near.empty() && !bounds.overlaps(body_tree.bounds())) return false;
  for (const int f : near) {
    for (int e = 0; e < impl.tool.edges.cols(); ++e)
      if (pierces(placed, impl.tool.edges.col(e), x, impl.body.triangles, f)) return true;
    for (int k = 0; k < 3; ++k)
      for (int t = 0; t < impl.tool.triangles.cols(); ++t)
        if (pierces(x, impl.body.edges.col(impl.body.triangle_edges(k, f)), placed, impl.tool.triangles, t))
          return true;
  }
  // No surface crosses the other: one is inside the other as a whole, or they are apart.
  if (contains_point(x, impl.body.triangles, placed.col(0))) return true;
  return contains_point(placed, impl.tool.triangles, x.col(impl.body.triangles(0, 0)));
}

}  // namespace argil::contact
