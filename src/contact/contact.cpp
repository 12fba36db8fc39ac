#include "contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "contact/detector.h"

namespace argil::contact {
namespace {

constexpr std::size_t kRoom = 256;  // what most contacts need of a list; it grows beyond

/// Does the edge p–q pierce a face?
bool pierces(const Vec3& p, const Vec3& q, const SurfaceAt& surface, int face) {
  const Vec3 a = surface.corner(face, 0);
  const Vec3 n = compute_face_normal(surface, face);
  const double dp = n.dot(p - a);
  const double dq = n.dot(q - a);
  if ((dp > 0.0) == (dq > 0.0)) return false;
  const Vec3 where = p + dp / (dp - dq) * (q - p);
  return compute_barycentric(where, a, surface.corner(face, 1), surface.corner(face, 2)).minCoeff() >= 0.0;
}

/// Radius of a sphere about `centre` that touches the nearest of the faces' planes from within, a little
/// less; 0 where the centre is outside.
double find_inner_radius(const SurfaceAt& convex, const Vec3& centre) {
  double highest = -std::numeric_limits<double>::infinity();
  for (int face = 0; face < static_cast<int>(convex.features.triangles.cols()); ++face)
    highest = std::max(highest, compute_height(convex, face, centre));
  return std::max(0.0, -highest) * (1.0 - 1e-9);
}

}  // namespace

void Contacts::clear() {
  contacts.clear();
  near.clear();
  touched_triangle.clear();
  touched_area.clear();
  sum_reactions(Vec3::Zero());
}

void Contacts::sum_reactions(const Vec3& hand) {
  force_on_tool.setZero();
  torque_on_tool.setZero();
  resistance_on_tool.setZero();
  resistance_torque_on_tool.setZero();
  for (const Contact& c : contacts) {
    force_on_tool -= c.force;
    torque_on_tool -= (c.point - hand).cross(c.force);
    resistance_on_tool -= c.resistance;
    resistance_torque_on_tool -= (c.point - hand).cross(c.resistance);
  }
}

ContactDetector::Impl::Impl(const Triangles& surface, int num_body_vertices,
                            const mesh::TriangleMesh& tool_mesh, const ContactParams& p)
    : params(p),
      body(surface, num_body_vertices),
      tool(tool_mesh.triangles, tool_mesh.num_vertices()),
      tool_rest(tool_mesh.vertices),
      tool_t0(Points::Zero(3, tool_mesh.num_vertices() + 1)),
      tool_t1(tool_t0),
      tool_vertices(tool_mesh.num_vertices()),
      body_vertices(num_body_vertices) {
  ARGIL_ASSERT(tool_mesh.num_triangles() > 0 && surface.cols() > 0);
  tool_centre = 0.5 * (tool_rest.rowwise().minCoeff() + tool_rest.rowwise().maxCoeff());
  tool_radius = (tool_rest.colwise() - tool_centre).colwise().norm().maxCoeff() * (1.0 + 1e-9);
  tool_reach = tool_rest.colwise().norm().maxCoeff();
  for (Eigen::Index e = 0; e < tool.edges.cols(); ++e)
    tool_edge_length += (tool_rest.col(tool.edges(0, e)) - tool_rest.col(tool.edges(1, e))).norm();
  const SurfaceAt at_rest{tool, tool_rest, tool_rest};
  tool_is_convex = tool.parts.size() == 1;
  for (int e = 0; e < static_cast<int>(tool.edges.cols()); ++e)
    for (int k = 0; k < 2; ++k)
      // The far corner of one face behind the plane of the other, but for rounding.
      if (compute_height(at_rest, tool.edge_triangles(k, e), tool_rest.col(tool.edge_opposite(1 - k, e))) >
          1e-12 * tool_reach)
        tool_is_convex = false;
  tool_edge_length /= static_cast<double>(tool.edges.cols());
  if (tool_is_convex) tool_inner_radius = find_inner_radius(at_rest, tool_centre);
  body_candidates.reserve(static_cast<std::size_t>(surface.cols()));
  areas.reserve(body_candidates.capacity());
  near_faces.resize(body_candidates.capacity());
  tasks.reserve(kRoom);
  for (std::vector<int>* list :
       {&committed.tool_vertex, &committed.body_face, &committed.body_vertex, &committed.tool_face})
    list->reserve(kRoom);
}

void ContactDetector::Impl::make_workers(const Points& x) {
  constexpr int kMost = 4;  // as many as a contact of some dozens of pairs can use
  workers.clear();
  for (int i = 0; i < std::min(threads, kMost); ++i) {
    Worker& worker = workers.emplace_back(
        Worker{BoundingTree(x, body.triangles), BoundingTree(tool_rest, tool.triangles)});
    worker.tool_tree.fit_all(tool_t0);
    worker.tool_candidates.reserve(static_cast<std::size_t>(tool.triangles.cols()));
    worker.tool_features.reserve(static_cast<std::size_t>(tool.edges.cols()));
    worker.has_edge.resize(static_cast<std::size_t>(tool.edges.cols()));
    worker.near_faces.reserve(kRoom * kRoom);
    worker.candidates.reserve(kRoom);
    worker.near.reserve(kRoom);
    worker.tool_entries.reserve(kRoom);
    worker.body_entries.reserve(kRoom);
    worker.edge_pairs.reserve(kRoom);
  }
}

void ContactDetector::Impl::place_tool(const Pose& pose, Points& out) const {
  const Mat3 R = pose.orientation.toRotationMatrix();
  for (Eigen::Index v = 0; v < tool_rest.cols(); ++v) out.col(v) = R * tool_rest.col(v) + pose.position;
}

/// Intervals join, so that the start is most often where the tool was placed last.
void ContactDetector::Impl::place_tool(const Pose& pose_t0, const Pose& pose_t1) {
  if (placed && placed->position == pose_t0.position &&
      placed->orientation.coeffs() == pose_t0.orientation.coeffs())
    tool_t0.swap(tool_t1);
  else
    place_tool(pose_t0, tool_t0);
  place_tool(pose_t1, tool_t1);
  placed = pose_t1;
}

/// Box around the bounding sphere on its way. Vertices move linearly between places within the spheres at
/// both ends, and the box is convex.
mesh::Box ContactDetector::Impl::tool_bounds() const {
  mesh::Box bounds;
  bounds.include(centre_t0);
  bounds.include(centre_t1);
  return bounds.grown(tool_radius);
}

ContactDetector::ContactDetector(const Triangles& surface, int num_body_vertices,
                                 const mesh::TriangleMesh& tool, const ContactParams& params)
    : m_impl(std::make_unique<Impl>(surface, num_body_vertices, tool, params)) {}
ContactDetector::~ContactDetector() = default;
ContactDetector::ContactDetector(ContactDetector&&) noexcept = default;
ContactDetector& ContactDetector::operator=(ContactDetector&&) noexcept = default;

void ContactDetector::prepare(const Points& x, const Pose& tool) {
  m_impl->place_tool(tool, m_impl->tool_t0);
  m_impl->make_workers(x);
}

void ContactDetector::find_contacts(const Points& x_t0, const Points& x_t1, const Pose& pose_t0,
                                    const Pose& pose_t1, Contacts& contacts,
                                    std::optional<double> body_motion, double seconds) {
  Impl& impl = *m_impl;
  ARGIL_ASSERT(impl.params.damping == 0.0 || seconds > 0.0, seconds);
  impl.seconds = seconds;
  contacts.clear();
  if (impl.workers.empty()) prepare(x_t0, pose_t0);
  const double moved = body_motion ? *body_motion : (x_t1 - x_t0).cwiseAbs().maxCoeff();
  const Mat3 turn = pose_t1.orientation.toRotationMatrix() - pose_t0.orientation.toRotationMatrix();
  const double tool_moved = (pose_t1.position - pose_t0.position).norm() + turn.norm() * impl.tool_reach;
  ARGIL_ASSERT(std::isfinite(moved + tool_moved), moved, tool_moved);
  for (Worker& worker : impl.workers) {
    worker.body_tree.advance(moved);
    worker.tool_tree.advance(tool_moved);
  }

  impl.centre_t0 = pose_t0.position + pose_t0.orientation * impl.tool_centre;
  impl.centre_t1 = pose_t1.position + pose_t1.orientation * impl.tool_centre;
  const mesh::Box tool_bounds = impl.tool_bounds();
  const bool is_carrying = !impl.tool_vertices.inside.empty() || !impl.body_vertices.inside.empty();
  if (!is_carrying &&
      !tool_bounds.overlaps(impl.workers.front().body_tree.bounds(), impl.params.minimum_separation)) {
    impl.edge_springs.clear();
    return;
  }

  impl.place_tool(pose_t0, pose_t1);
  const Motion motion{x_t0, x_t1, impl.tool_t0, impl.tool_t1};
  impl.find_entries(motion, tool_bounds);
  impl.press_vertices(motion, contacts);
  impl.press_edges(motion, contacts);
  impl.measure_touched(motion, contacts);
  contacts.sum_reactions(pose_t1.position);
}

bool ContactDetector::overlaps(const Points& x, const Pose& pose) const {
  const Impl& impl = *m_impl;
  Points placed(3, impl.tool_rest.cols());
  impl.place_tool(pose, placed);
  BoundingTree body_tree(x, impl.body.triangles);
  BoundingTree tool_tree(placed, impl.tool.triangles);
  if (!body_tree.bounds().overlaps(tool_tree.bounds())) return false;
  const SurfaceAt body{impl.body, x, x};
  const SurfaceAt tool{impl.tool, placed, placed};
  std::vector<int> body_faces;
  std::vector<int> tool_faces;
  body_tree.find_overlaps(tool_tree.bounds(), x, x, body_faces);
  for (const int f : body_faces) {
    mesh::Box box;
    for (int k = 0; k < 3; ++k) box.include(body.corner(f, k));
    tool_faces.clear();
    tool_tree.find_overlaps(box, placed, placed, tool_faces);
    for (const int g : tool_faces)
      for (int k = 0; k < 3; ++k)
        if (pierces(body.corner(f, k), body.corner(f, (k + 1) % 3), tool, g) ||
            pierces(tool.corner(g, k), tool.corner(g, (k + 1) % 3), body, f))
          return true;
  }
  // Neither surface crosses the other: a part of one is inside the other as a whole, or they are apart.
  const auto is_any_inside = [](const SurfaceAt& surface, BoundingTree& tree, const SurfaceAt& other) {
    return std::any_of(other.features.parts.begin(), other.features.parts.end(),
                       [&](int face) { return is_inside(surface, tree, other.corner(face, 0), 0); });
  };
  return is_any_inside(body, body_tree, tool) || is_any_inside(tool, tool_tree, body);
}

void ContactDetector::Impl::copy_state(ContactState& out) const {
  const auto copy = [this](const VertexSide& side, std::vector<int>& vertices, std::vector<int>& faces,
                           std::vector<Vec3>& stretch) {
    vertices = side.inside;
    faces.clear();
    stretch.clear();
    for (const int v : vertices) faces.push_back(side.face_of_vertex[static_cast<std::size_t>(v)]);
    if (params.friction == 0.0) return;
    for (const int v : vertices) stretch.push_back(side.stretch[static_cast<std::size_t>(v)]);
  };
  copy(tool_vertices, out.tool_vertex, out.body_face, out.tool_stretch);
  copy(body_vertices, out.body_vertex, out.tool_face, out.body_stretch);
  out.edges.clear();
  out.edge_stretch.clear();
  if (params.friction == 0.0) return;
  for (const EdgeSpring& spring : edge_springs) {
    out.edges.push_back(spring.key);
    out.edge_stretch.push_back(spring.stretch);
  }
}

ContactState ContactDetector::state() const {
  ContactState state;
  m_impl->copy_state(state);
  return state;
}

void ContactDetector::commit() {
  m_impl->copy_state(m_impl->committed);
}

void ContactDetector::roll_back() {
  restore(m_impl->committed);
}

void ContactDetector::restore(const ContactState& state) {
  const auto fill = [](VertexSide& side, const std::vector<int>& vertices, const std::vector<int>& faces,
                       const std::vector<Vec3>& stretch, Eigen::Index num_faces) {
    ARGIL_ASSERT(vertices.size() == faces.size() && std::is_sorted(vertices.begin(), vertices.end()));
    std::fill(side.face_of_vertex.begin(), side.face_of_vertex.end(), -1);
    side.inside = vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      ARGIL_ASSERT(faces[i] >= 0 && faces[i] < num_faces, faces[i]);
      side.face_of_vertex.at(static_cast<std::size_t>(vertices[i])) = faces[i];
      if (!stretch.empty()) side.stretch.at(static_cast<std::size_t>(vertices[i])) = stretch.at(i);
    }
  };
  fill(m_impl->tool_vertices, state.tool_vertex, state.body_face, state.tool_stretch,
       m_impl->body.triangles.cols());
  fill(m_impl->body_vertices, state.body_vertex, state.tool_face, state.body_stretch,
       m_impl->tool.triangles.cols());
  m_impl->edge_springs.clear();
  for (std::size_t i = 0; i < state.edges.size(); ++i)
    m_impl->edge_springs.push_back({state.edges[i], state.edge_stretch.at(i)});
  m_impl->workers.clear();
  commit();
}

void ContactDetector::share(int threads) {
  ARGIL_ASSERT(threads >= 1, threads);
  m_impl->threads = threads;
  m_impl->workers.clear();
}

}  // namespace argil::contact
