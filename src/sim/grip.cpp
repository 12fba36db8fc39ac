#include "sim/grip.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "contact/nearest.h"

namespace argil::sim {
namespace {

constexpr double kStiffness = 50.0;  // of all bonds, over that of a half-space under the patch

struct VertexForce {
  int vertex = -1;
  Vec3 force = Vec3::Zero();
};

/// What presses on each vertex at the end of the way.
std::vector<VertexForce> find_vertex_forces(const contact::Contacts& contacts) {
  std::vector<VertexForce> parts;
  for (const contact::Contact& c : contacts.contacts)
    for (std::size_t k = 0; k < 3 && c.vertex[k] >= 0; ++k)
      parts.push_back({c.vertex[k], c.weight[k] * c.end_force * c.normal});
  std::stable_sort(parts.begin(), parts.end(),
                   [](const VertexForce& a, const VertexForce& b) { return a.vertex < b.vertex; });
  std::vector<VertexForce> sums;
  for (const VertexForce& part : parts) {
    if (sums.empty() || sums.back().vertex != part.vertex) sums.push_back({part.vertex});
    sums.back().force += part.force;
  }
  std::erase_if(sums, [](const VertexForce& f) { return f.force.isZero(0.0); });
  return sums;
}

Vec3 place_in_world(const contact::Pose& tool, const Vec3& place) {
  return tool.position + tool.orientation * place;
}

/// Of a disc on which a ball would press as far apart [m]: the mean square distance of Hertz's pressure from
/// the middle is 2/5 of its radius squared. `get`: force [N] and place of each of `parts`.
template <class Parts, class Get>
double find_radius(const Parts& parts, Get get) {
  double sum = 0.0;
  Vec3 centre = Vec3::Zero();
  for (const auto& part : parts) {
    const auto [force, place] = get(part);
    if (!(force > 0.0)) continue;
    sum += force;
    centre += force / sum * (place - centre);
  }
  double square = 0.0;
  for (const auto& part : parts) {
    const auto [force, place] = get(part);
    if (force > 0.0) square += force / sum * (place - centre).squaredNorm();
  }
  return std::sqrt(2.5 * square);
}

}  // namespace

void Grip::hold(const contact::Contacts& contacts, const contact::Patch& patch, const Points& x,
                const Vec3& on_hand, const contact::Pose& tool) {
  const std::vector<VertexForce> forces = find_vertex_forces(contacts);
  const double of_vertices = find_radius(
      forces, [&](const VertexForce& f) { return std::pair(f.force.norm(), Vec3(x.col(f.vertex))); });
  const double stiffness = kStiffness * 2.0 * patch.modulus * std::max(patch.radius, of_vertices);
  double squares = 0.0;
  for (const VertexForce& f : forces) squares += f.force.squaredNorm();
  const Quat to_tool = tool.orientation.conjugate();
  m_state.bonds.clear();
  Vec3 on_body = Vec3::Zero();
  for (const auto& [vertex, force] : forces) {
    on_body += force;
    const double part = force.squaredNorm() / squares * stiffness;
    const Vec3 place = x.col(vertex) + force / part;
    m_state.bonds.push_back({vertex, to_tool * (place - tool.position), to_tool * force.normalized(), part});
  }
  // In a dent a ball touches faces in their middles alone: the patch reaches as far as what presses.
  const double of_points = find_radius(
      contacts.contacts, [](const contact::Contact& c) { return std::pair(c.end_force, c.point); });
  const double radius = std::max(patch.radius, of_points);
  m_state.area = std::numbers::pi * radius * radius;
  const Vec3 normal = find_normal(tool);
  m_state.pressing_force = holds() ? std::max({0.0, on_body.dot(normal), -on_hand.dot(normal)}) : 0.0;
}

Vec3 Grip::find_normal(const contact::Pose& tool) const {
  Vec3 normal = Vec3::Zero();
  for (const Bond& bond : m_state.bonds) normal += bond.stiffness * bond.normal;
  return tool.orientation * normal.normalized();
}

void Grip::go_on_from(const Grip& before, const Points& x_before, const Points& x,
                      const contact::Pose& tool) {
  m_state = before.m_state;
  const double radius = std::sqrt(m_state.area / std::numbers::pi);
  double whole = 0.0, lost = 0.0;
  for (Bond& bond : m_state.bonds) {
    const Vec3 at = x_before.col(bond.vertex);
    bond.vertex = contact::find_nearest_point(x, at);
    const Vec3 way = x.col(bond.vertex) - at;
    bond.place += tool.orientation.conjugate() * way;
    whole += bond.stiffness;
    if (!(way.norm() <= radius)) lost += bond.stiffness;
  }
  if (lost > 0.5 * whole) {
    m_state.bonds.clear();
    m_state.has_let_go = true;
  }
  commit();
}

void Grip::test(const Vec3& on_hand, const contact::Pose& tool) {
  if (!holds()) return;
  const Vec3 normal = find_normal(tool);
  const double pressing = std::max(0.0, -on_hand.dot(normal));
  if (pressing > m_state.pressing_force) return release();
  const Vec3 pull = on_hand + pressing * normal;
  if (pull.norm() <= m_strength * m_state.area) return;
  m_state.bonds.clear();
  m_state.has_let_go = true;
}

void Grip::find_contacts(const Points& x, const contact::Pose& from, const contact::Pose& to,
                         contact::Contacts& contacts) const {
  contacts.clear();
  for (const Bond& bond : m_state.bonds) {
    const Vec3 point = x.col(bond.vertex);
    const Vec3 end = place_in_world(to, bond.place) - point;
    const Vec3 mean = 0.5 * (place_in_world(from, bond.place) - point + end);
    contact::Contact c;
    c.vertex = {bond.vertex, -1, -1};
    c.weight = {1.0, 0.0, 0.0};
    c.normal = to.orientation * bond.normal;
    c.force = bond.stiffness * mean;
    c.stiffness = c.end_stiffness = c.spring = bond.stiffness;
    c.end_force = bond.stiffness * c.normal.dot(end);
    c.point = point;
    contacts.contacts.push_back(c);
  }
  contacts.sum_reactions(to.position);
}

void Grip::serialize(Archive& archive) {
  archive.number("grip/has_let_go", m_state.has_let_go);
  archive.number("grip/area", m_state.area);
  archive.number("grip/pressing_force", m_state.pressing_force);
  archive.records("grip/bonds", m_state.bonds, [](Bond& bond, auto field) {
    field(bond.vertex);
    for (double& value : bond.place) field(value);
    for (double& value : bond.normal) field(value);
    field(bond.stiffness);
  });
  if (archive.is_restoring()) commit();
}

}  // namespace argil::sim
