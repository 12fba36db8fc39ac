// Forces: penalty integrals of every pair in penetration, and what is carried to the next interval.

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "contact/detector.h"

namespace argil::contact {
namespace {

// The common normal of nearly parallel edges is at the mercy of rounding: between one and two times this
// sine² of their angle the pair fades in.
constexpr double kParallelSine2 = 1e-3;

double compute_parallel_fade(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0];
  const Vec3 b = p[3] - p[2];
  const double sine2 = a.cross(b).squaredNorm() / (a.squaredNorm() * b.squaredNorm());
  return std::clamp(sine2 / kParallelSine2 - 1.0, 0.0, 1.0);
}

double find_distance(const VertexFaceMotion& m, int v, int face, double t, Worker& worker) {
  const SurfaceAt faces{m.faces.features, m.faces.x_t0, m.faces.x_t1, t};
  return find_signed_distance(faces, m.tree(worker), m.vertex_at(v, t), face);
}

/// When does a vertex that is inside where `span` begins and outside where it ends, by `end_distance`, come
/// out? A time just after. Its distance from the surface, negative inside, changes its sign there: regula
/// falsi, by turns a little before and after where a chord puts that, so that both ends close in; halves
/// where there is no chord.
double find_exit(const VertexFaceMotion& m, int v, int face, const Interval& span, double end_distance,
                 Worker& worker) {
  constexpr double kExact = 1.0 / 4096.0;  // of the interval
  constexpr int kChords = 6;               // after which halves are the safer way
  struct {
    double time, distance;
  } inside{span.begin, 0.0}, outside{span.end, end_distance};
  inside.distance = std::min(0.0, find_distance(m, v, face, span.begin, worker));
  double aside = 0.25 * kExact;
  for (int i = 0; outside.time - inside.time > kExact; ++i) {
    const double width = outside.time - inside.time;
    const bool has_chord = inside.distance < 0.0 && i < kChords;
    const double chord = inside.distance / (inside.distance - outside.distance);
    const double t = has_chord ? std::clamp(inside.time + chord * width + aside, inside.time + 0.25 * kExact,
                                            outside.time - 0.25 * kExact)
                               : inside.time + 0.5 * width;
    const double distance = find_distance(m, v, face, t, worker);
    if (distance < 0.0)
      inside = {t, distance};
    else
      outside = {t, distance};
    aside = distance < 0.0 ? 0.25 * kExact : -0.25 * kExact;
  }
  return outside.time;
}

/// A vertex that is outside at t₁, `end_distance` from the surface, has left sideways, unless its last
/// interval ended by a crossing of the plane within the face: then it pressed until it came out, not until
/// the plane.
Penalty end_sideways(const VertexFaceMotion& m, const VertexTask& task, const PairPath& path,
                     const Penalty& penalty, double end_distance, Worker& worker) {
  const Interval& last = penalty.intervals[static_cast<std::size_t>(penalty.num_intervals) - 1];
  if (!penalty.inside_at_end) {
    const std::array<Vec3, 4> x = interpolate(path, last.end);
    if (compute_barycentric(x[0], x[1], x[2], x[3]).minCoeff() >= -kInsideMargin) return penalty;
    end_distance = find_distance(m, task.vertex, task.face, last.end, worker);
    if (!(end_distance > 0.0)) return penalty;
  }
  return compute_vertex_face_penalty(path, task.was_inside,
                                     find_exit(m, task.vertex, task.face, last, end_distance, worker));
}

/// Places on a surface about a vertex that may lie behind it.
struct Surroundings {
  SurfacePoint walked;   ///< the nearest one that the vertex can have slid to
  SurfacePoint nearest;  ///< of the whole surface
};

/// From the face where the vertex was. Leaves in worker.near, by number, the faces less than (1 + blend)
/// times as far from p as that face.
Surroundings find_surroundings(const VertexFaceMotion& m, const Vec3& p, int face, double blend,
                               Worker& worker) {
  std::vector<NearFace>& near = worker.near;
  near.clear();
  Surroundings out;
  out.nearest = compute_nearest_on_face(m.faces, face, p);
  const double reach = (1.0 + blend) * (1.0 + blend) * out.nearest.squared_distance;
  m.tree(worker).find_near(p, reach, m.faces.x_t0, m.faces.x_t1, worker.candidates);
  for (const int other : worker.candidates) {
    const SurfacePoint found = compute_nearest_on_face(m.faces, other, p);
    if (is_nearer(found, out.nearest)) out.nearest = found;
    if (found.squared_distance < reach) near.push_back({other, found.squared_distance});
  }
  // Not in the order of the tree's boxes, which depend on the past.
  std::sort(near.begin(), near.end(), [](const NearFace& a, const NearFace& b) { return a.face < b.face; });
  out.walked = walk_to_nearest(m.faces, p, face, near);
  return out;
}

/// What turns the force of a vertex behind `nearest` into the mean over the near faces: Σ w h n over
/// (Σ w) times the depth behind the nearest face, where h is the depth behind each face and w fades from 1 at
/// the nearest distance d to 0 at (1 + blend)·d. Faces that look the other way, beyond 90° to 120°, are the
/// far side of a thin part and do not count. A function of the positions alone: the face that the vertex is
/// booked on does not matter, so that handing over makes no jump. None where all those faces lie in one
/// plane: then eq. 7 stands.
std::optional<Vec3> find_blended_direction(const VertexFaceMotion& m, const Vec3& p,
                                           const SurfacePoint& nearest, double blend,
                                           std::span<const NearFace> near) {
  const Vec3 normal = compute_face_normal(m.faces, nearest.face).normalized();
  const double depth = -compute_height(m.faces, nearest.face, p);
  if (!(blend > 0.0) || !(depth > 0.0)) return {};
  const double reach = (1.0 + blend) * (1.0 + blend) * nearest.squared_distance;
  double sum = 0.0;
  Vec3 direction = Vec3::Zero();
  bool is_flat = true;
  constexpr double kSamePlane = 1e-12;  // 1 − cos of the angle between two faces: rounding
  for (const auto& [face, squared_distance] : near) {
    if (!(squared_distance < reach)) continue;
    const Vec3 n = compute_face_normal(m.faces, face).normalized();
    const double alike = n.dot(normal);
    const double nearness = (1.0 + blend - std::sqrt(squared_distance / nearest.squared_distance)) / blend;
    const double w = std::clamp(nearness, 0.0, 1.0) * std::clamp(1.0 + 2.0 * alike, 0.0, 1.0);
    sum += w;
    direction += w * std::min(0.0, n.dot(p - m.faces.corner(face, 0))) * n;
    is_flat = is_flat && (w == 0.0 || alike > 1.0 - kSamePlane);
  }
  if (is_flat || !(sum > 0.0)) return {};
  direction /= sum * depth;
  return direction / std::max(1.0, direction.norm());
}

/// Does the nearest place lie on an edge or a corner? Then several faces have it, and none of them is
/// distinguished.
bool is_shared(const SurfacePoint& place) {
  return (place.weight.array() == 0.0).any();
}

/// Depth of a vertex behind the place nearest to it at the end of the interval, as if it had it throughout:
/// along the face's normal, or, where faces meet, along the way to that place.
Penalty compute_vertex_face_depth(const VertexFaceMotion& m, const Vec3& p, const SurfacePoint& nearest) {
  Penalty penalty;
  const Vec3 n = compute_face_normal(m.faces, nearest.face).normalized();
  penalty.integral = is_shared(nearest) ? Vec3(p - nearest.point)
                                        : Vec3(std::min(0.0, compute_height(m.faces, nearest.face, p)) * n);
  penalty.weights = {1.0, nearest.weight(0), nearest.weight(1), nearest.weight(2)};
  penalty.duration = 1.0;
  return penalty;
}

/// Depth of two edges that cross in penetration at the end of the interval, as if they had it throughout.
Penalty compute_edge_edge_depth(const PairPath& path) {
  Penalty penalty;
  const std::array<Vec3, 4>& p = path.t1;
  const Vec3 n = (p[1] - p[0]).cross(p[3] - p[2]).normalized();
  const Eigen::Vector2d s = compute_line_parameters(p);
  penalty.integral = n.dot(p[0] - p[2]) * n;
  penalty.weights = {1.0 - s(0), s(0), 1.0 - s(1), s(1)};
  penalty.duration = 1.0;
  penalty.num_intervals = 1;
  penalty.inside_at_end = true;
  return penalty;
}

/// Eq. 8. Edges that are inside at t₁ alone but begin on the same side came in sideways, unless their lines
/// crossed beyond an end and they then met: the depth counts from there.
Penalty compute_edge_pair_penalty(const EdgePair& pair, const PairPath& path, bool starts_inside,
                                  double orientation) {
  if (starts_inside && !pair.inside_t0) {
    const Penalty entered = compute_edge_edge_penalty(path, false, 0.0);
    if (entered.inside_at_end) return entered;
  }
  return compute_edge_edge_penalty(path, starts_inside, orientation);
}

/// The contact of a vertex with a face, seen from the body.
Contact make_vertex_contact(const VertexFaceMotion& m, int v, int face, const Penalty& penalty, double k) {
  // On the face's body the force is the integral; where the vertex is the body's, its negative.
  const double sign = m.body_has_face ? 1.0 : -1.0;
  Contact c;
  if (m.body_has_face) {
    const Eigen::Vector3i f = m.faces.features.triangles.col(face);
    c.vertex = {f(0), f(1), f(2)};
    c.weight = {penalty.weights[1], penalty.weights[2], penalty.weights[3]};
    for (int i = 0; i < 3; ++i) c.point += c.weight[static_cast<std::size_t>(i)] * m.faces.corner(face, i);
  } else {
    c.vertex = {v, -1, -1};
    c.weight = {1.0, 0.0, 0.0};
    c.point = m.v_t1.col(v);
  }
  c.normal = sign * penalty.integral.normalized();
  c.force = sign * k * penalty.integral;
  c.stiffness = k * penalty.duration;
  return c;
}

}  // namespace

/// Eq. 7. Every vertex presses on one face: the one it entered through, and after each interval the one that
/// it can have slid to. It is carried as long as it is inside the surface as a whole, so that a vertex which
/// left sideways, or through the far side, exerts no force any more.
void ContactDetector::Impl::press_vertices(const Motion& motion, Contacts& out) {
  const VertexFaceMotion of_tool = tool_vertex_motion(motion);
  const VertexFaceMotion of_body = body_vertex_motion(motion);
  tasks.clear();
  for (const VertexFaceMotion* m : {&of_tool, &of_body}) {
    add_tasks(*m);
    VertexSide& side = m->side;
    for (const int v : side.pressed) side.depth[static_cast<std::size_t>(v)] = 0.0;
    side.pressed.clear();
    side.inside.clear();
  }
  each_item(tasks.size(), [&](Worker& worker, std::size_t i) { resolve(tasks[i], worker); });
  for (const VertexTask& task : tasks) {
    VertexSide& side = task.motion->side;
    if (task.inside) side.inside.push_back(task.vertex);
    if (!(task.depth > 0.0)) continue;
    side.depth[static_cast<std::size_t>(task.vertex)] = task.depth;
    side.pressed.push_back(task.vertex);
    out.contacts.push_back(task.contact);
  }
}

/// By vertex: those that were inside and those that met a face.
void ContactDetector::Impl::add_tasks(const VertexFaceMotion& m) {
  const VertexSide& side = m.side;
  auto entry = side.entries.cbegin();
  auto old = side.inside.cbegin();
  while (old != side.inside.cend() || entry != side.entries.cend()) {
    if (entry == side.entries.cend() || (old != side.inside.cend() && *old < entry->vertex)) {
      const int v = *old++;
      tasks.push_back({&m, v, side.face_of_vertex[static_cast<std::size_t>(v)], true});
      continue;
    }
    // Of the faces the vertex met, the earliest through whose plane it really went in takes it. If rounding
    // shows none, the first still decides whether it is carried.
    const int v = entry->vertex;
    int face = entry->face;
    bool is_found = false;
    for (; entry != side.entries.cend() && entry->vertex == v; ++entry) {
      if (is_found || !enters_face(m.path(v, entry->face))) continue;
      is_found = true;
      face = entry->face;
    }
    tasks.push_back({&m, v, face, false});
  }
}

/// What becomes of a vertex; changes nothing that belongs to another.
void ContactDetector::Impl::resolve(VertexTask& task, Worker& worker) const {
  const VertexFaceMotion& m = *task.motion;
  const int v = task.vertex;
  int face = task.face;
  const bool was_inside = task.was_inside;
  PairPath path = m.path(v, face);
  Vec3& stretch = m.side.stretch[static_cast<std::size_t>(v)];
  if (!was_inside) stretch.setZero();
  const bool is_discrete = params.penalty == PenaltyKind::discrete;
  Penalty penalty;
  if (!is_discrete) penalty = compute_vertex_face_penalty(path, was_inside);
  const Vec3 p = m.v_t1.col(v);
  const auto [walked, nearest] = find_surroundings(m, p, face, params.face_blend, worker);
  const bool inside = is_behind(m.faces, nearest, p);
  task.inside = inside;
  m.side.face_of_vertex[static_cast<std::size_t>(v)] = inside ? walked.face : -1;
  if (!inside && penalty.num_intervals > 0)
    penalty = end_sideways(m, task, path, penalty, std::sqrt(nearest.squared_distance), worker);
  if (is_discrete && inside) {
    face = nearest.face;
    path = m.path(v, face);
    penalty = compute_vertex_face_depth(m, p, nearest);
  }
  double end_depth = inside ? std::max(0.0, -compute_height(m.faces, face, p)) : 0.0;
  if (is_discrete && inside && is_shared(nearest)) end_depth = penalty.integral.norm();
  if (inside && !is_discrete)
    if (const auto direction = find_blended_direction(m, p, walked, params.face_blend, worker.near)) {
      penalty.integral = penalty.integral.norm() * *direction;
      end_depth = -compute_height(m.faces, walked.face, p) * direction->norm();
    }
  task.depth = penalty.integral.norm();
  if (!inside && !(task.depth > 0.0)) stretch.setZero();
  if (!(task.depth > 0.0)) return;
  Contact& c = task.contact;
  c = make_vertex_contact(m, v, face, penalty, params.vertex_face_stiffness);
  c.end_force = params.vertex_face_stiffness * end_depth;
  c.end_stiffness = inside ? params.vertex_face_stiffness : 0.0;
  c.passes = !was_inside && !inside;
  if (resists()) resist_vertex(m, v, path, penalty, was_inside, inside, c);
}

/// Share of an edge pair's depth that its end vertices do not press already: 1 while none of them is inside,
/// 0 once one is as deep as the pair. Without it one dent would count at the vertices and again at every
/// crossing of edges between them; with it the pair brings what it lies deeper, k·max(d_edges, d_vertex) in
/// all, which is continuous when a vertex enters or leaves beside it.
double ContactDetector::Impl::compute_uncovered_share(const EdgePair& pair, double depth) const {
  double covered = 0.0;
  for (int k = 0; k < 2; ++k) {
    covered = std::max(covered, tool_vertices.depth[static_cast<std::size_t>(tool.edges(k, pair.tool_edge))]);
    covered = std::max(covered, body_vertices.depth[static_cast<std::size_t>(body.edges(k, pair.body_edge))]);
  }
  return std::max(0.0, 1.0 - covered / depth);
}

/// Do the pair's crossing points lie inside the other surface? Tells edges in penetration from edges whose
/// lines merely pass each other somewhere.
bool ContactDetector::Impl::is_edge_pair_inside(const EdgePair& pair, const Motion& m, double t) {
  const SurfaceAt body_at{body, t == 1.0 ? m.body_t1 : m.body_t0, t == 1.0 ? m.body_t1 : m.body_t0};
  const SurfaceAt tool_at{tool, t == 1.0 ? m.tool_t1 : m.tool_t0, t == 1.0 ? m.tool_t1 : m.tool_t0};
  const PairPath path = make_edge_path(m, tool.edges.col(pair.tool_edge), body.edges.col(pair.body_edge));
  const std::array<Vec3, 4>& x = t == 1.0 ? path.t1 : path.t0;
  const Eigen::Vector2d s = compute_line_parameters(x);
  const Vec3 p = x[0] + s(0) * (x[1] - x[0]);
  const Vec3 q = x[2] + s(1) * (x[3] - x[2]);
  return is_inside(tool_at, workers.front().tool_tree, q, tool.edge_triangles(0, pair.tool_edge)) &&
         is_inside(body_at, workers.front().body_tree, p, body.edge_triangles(0, pair.body_edge));
}

/// Eq. 8 with p on the tool's edge and q on the body's. Edges carry nothing from interval to interval:
/// whether a pair is in penetration is read off the positions, so that neighbouring edges take over from each
/// other.
void ContactDetector::Impl::press_edges(const Motion& m, Contacts& out) {
  edge_springs_next.clear();
  for (const EdgePair& pair : edge_pairs) {
    const Eigen::Vector2i b = body.edges.col(pair.body_edge);
    const PairPath path = make_edge_path(m, tool.edges.col(pair.tool_edge), b);
    const double fade = compute_parallel_fade(path.t1);
    if (!(fade > 0.0)) continue;
    // The normal's sign makes inside negative at the end where the pair is known to be inside.
    double orientation = 0.0;
    bool starts_inside = false;
    if (pair.inside_t0 || pair.inside_t1) {
      const std::array<double, 4> c = compute_coplanarity(PairKind::edge_edge, path);
      orientation = (pair.inside_t1 ? c[3] : c[0]) < 0.0 ? 1.0 : -1.0;
      starts_inside = orientation * c[0] < 0.0;
    }
    const bool is_discrete = params.penalty == PenaltyKind::discrete;
    if (is_discrete && !pair.inside_t1) continue;
    const Penalty penalty = is_discrete ? compute_edge_edge_depth(path)
                                        : compute_edge_pair_penalty(pair, path, starts_inside, orientation);
    // Inside by its lines at the end but not within the edges: slid off, and a neighbour has it.
    if (penalty.num_intervals == 0 || (penalty.inside_at_end && !pair.inside_t1)) continue;
    if (orientation == 0.0) {
      // In and out within the interval. Edges that part after coming alongside cross too, the other way
      // round.
      const Vec3 n = penalty.orientation * (path.t1[1] - path.t1[0]).cross(path.t1[3] - path.t1[2]);
      if (!is_in_normal_cone({body, m.body_t0, m.body_t1}, pair.body_edge, n) ||
          !is_in_normal_cone({tool, m.tool_t0, m.tool_t1}, pair.tool_edge, -n))
        continue;
    }
    const double depth = penalty.integral.norm();
    const double share = fade * compute_uncovered_share(pair, depth);
    constexpr double kNegligible = 1e-9;  // of the depth: rounding where a vertex covers the pair
    if (!(share > kNegligible) || !(depth > 0.0)) continue;
    if ((pair.inside_t0 || pair.inside_t1) && !is_edge_pair_inside(pair, m, pair.inside_t1 ? 1.0 : 0.0))
      continue;
    Contact c;
    c.vertex = {b(0), b(1), -1};
    c.weight = {penalty.weights[2], penalty.weights[3], 0.0};
    c.normal = penalty.integral / depth;
    c.force = share * params.edge_edge_stiffness * penalty.integral;
    c.stiffness = share * params.edge_edge_stiffness * penalty.duration;
    c.end_stiffness = pair.inside_t1 ? share * params.edge_edge_stiffness : 0.0;
    c.end_force = pair.inside_t1 ? c.end_stiffness * compute_edge_edge_depth(path).integral.norm() : 0.0;
    c.passes = !pair.inside_t0 && !pair.inside_t1;
    c.point = c.weight[0] * path.t1[2] + c.weight[1] * path.t1[3];
    if (resists()) resist_edges(pair, path, penalty, share, c);
    out.contacts.push_back(c);
  }
  std::swap(edge_springs, edge_springs_next);
}

}  // namespace argil::contact
