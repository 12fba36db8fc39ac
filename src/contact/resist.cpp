// Damping and friction of a pair whose normal force is known.

#include <algorithm>

#include "contact/detector.h"

namespace argil::contact {

/// Damping: k λ d ḋ, whose mean over the interval is k λ (d₁² − d₀²)/(2 Δt) [Hunt1975]; with the discrete
/// penalty k λ d₁ (d₁ − d₀)/Δt. It takes no more than the elastic force, so that nothing sticks to the tool.
/// Friction: a spring as stiff as the pair carries what the tool drags along the surface, up to μ times the
/// normal force; beyond, it slides after [Cundall1979].
void ContactDetector::Impl::resist(const PairMotion& m, Vec3& stretch, Contact& c) const {
  const Vec3 n = c.normal;
  double normal_force = c.force.norm();
  if (params.damping > 0.0) {
    const double change = params.penalty == PenaltyKind::discrete
                              ? m.depth_t1 * (m.depth_t1 - m.depth_t0)
                              : 0.5 * (m.depth_t1 * m.depth_t1 - m.depth_t0 * m.depth_t0);
    const double force = m.stiffness * params.damping * change / seconds;
    if (force > -normal_force) {
      c.damping = m.stiffness * params.damping * m.depth_t1;
      c.body_speed = n.dot(m.body_path) / seconds;
    }
    c.resistance += std::max(force, -normal_force) * n;
    normal_force = std::max(0.0, normal_force + force);
  }
  if (params.friction == 0.0) return;
  stretch += m.share * (m.tool_path - m.body_path);
  stretch -= n.dot(stretch) * n;
  const double limit = params.friction * normal_force / m.stiffness;
  const double length = stretch.norm();
  if (length > limit) {
    stretch *= limit / length;
    // μ N s/|s| turns with the stretch s: its derivative is μ N/|s| = k across s, and 0 along it.
    c.sticking = limit > 0.0 ? -m.stiffness : 0.0;
  } else {
    c.sticking = m.stiffness;
  }
  c.resistance += m.stiffness * stretch;
}

void ContactDetector::Impl::resist_vertex(const VertexFaceMotion& m, int v, const PairPath& path,
                                          const Penalty& penalty, bool was_inside, bool inside,
                                          Contact& c) const {
  // Of a discrete depth behind an edge or a corner, where faces meet, none of them is distinguished.
  const bool is_behind_edge = params.penalty == PenaltyKind::discrete && inside &&
                              std::count(penalty.weights.begin() + 1, penalty.weights.end(), 0.0) > 0;
  const Vec3 inward = penalty.integral.normalized();
  const auto depth = [&](const std::array<Vec3, 4>& p) {
    if (!is_behind_edge)
      return std::max(0.0, -(p[2] - p[1]).cross(p[3] - p[1]).normalized().dot(p[0] - p[1]));
    Vec3 way = p[0];
    for (std::size_t i = 1; i < 4; ++i) way -= penalty.weights[i] * p[i];
    return std::max(0.0, inward.dot(way));
  };
  PairMotion pair;
  pair.stiffness = params.vertex_face_stiffness;
  pair.depth_t0 = was_inside ? depth(path.t0) : 0.0;
  pair.depth_t1 = inside ? depth(path.t1) : 0.0;
  pair.share = penalty.duration;
  Vec3 face_path = Vec3::Zero();
  for (std::size_t i = 1; i < 4; ++i) face_path += penalty.weights[i] * (path.t1[i] - path.t0[i]);
  const Vec3 vertex_path = path.t1[0] - path.t0[0];
  pair.tool_path = m.body_has_face ? vertex_path : face_path;
  pair.body_path = m.body_has_face ? face_path : vertex_path;
  resist(pair, m.side.stretch[static_cast<std::size_t>(v)], c);
}

void ContactDetector::Impl::resist_edges(const EdgePair& edges, const PairPath& path, const Penalty& penalty,
                                         double share, Contact& c) {
  const auto depth = [](const std::array<Vec3, 4>& p) {
    return std::abs((p[1] - p[0]).cross(p[3] - p[2]).normalized().dot(p[0] - p[2]));
  };
  PairMotion pair;
  pair.stiffness = share * params.edge_edge_stiffness;
  pair.depth_t0 = edges.inside_t0 ? depth(path.t0) : 0.0;
  pair.depth_t1 = edges.inside_t1 ? depth(path.t1) : 0.0;
  pair.share = penalty.duration;
  for (std::size_t i = 0; i < 2; ++i) {
    pair.tool_path += penalty.weights[i] * (path.t1[i] - path.t0[i]);
    pair.body_path += penalty.weights[i + 2] * (path.t1[i + 2] - path.t0[i + 2]);
  }
  const auto before =
      std::lower_bound(edge_springs.begin(), edge_springs.end(), edges.key(),
                       [](const EdgeSpring& spring, const auto& key) { return spring.key < key; });
  EdgeSpring spring{edges.key()};
  if (before != edge_springs.end() && before->key == spring.key) spring.stretch = before->stretch;
  resist(pair, spring.stretch, c);
  if (edges.inside_t1) edge_springs_next.push_back(spring);
}

}  // namespace argil::contact
