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

/// Of a disc on which a ball would press as far from the middle [m]: the mean distance of Hertz's pressure
/// from it is 3π/16 of its radius. The force on the vertices hardly hangs on κ, nor does their mean distance;
/// the area that the tool covers, and the points of faces that bear it, do.
double find_radius(const std::vector<VertexForce>& forces, const Points& x) {
  double sum = 0.0;
  Vec3 centre = Vec3::Zero();
  for (const auto& [vertex, force] : forces) {
    sum += force.norm();
    centre += force.norm() / sum * (x.col(vertex) - centre);
  }
  double distance = 0.0;
  for (const auto& [vertex, force] : forces) distance += force.norm() / sum * (x.col(vertex) - centre).norm();
  return 16.0 / (3.0 * std::numbers::pi) * distance;
}

}  // namespace

void Grip::release() {
  m_state.bonds.clear();
  m_state.has_let_go = false;
}

void Grip::remember(const contact::Contacts& contacts) {
  m_state.pressed.clear();
  for (const auto* list : {&contacts.contacts, &contacts.near})
    for (const contact::Contact& c : *list)
      m_state.pressed.push_back({c.vertex, c.weight, c.normal, c.force.dot(c.normal), c.stiffness});
}

void Grip::find_pressed(const Points& x_before, const Points& x, contact::Contacts& contacts) const {
  if (m_state.pressed.empty()) return;
  contacts.clear();
  for (const Pressed& pressed : m_state.pressed) {
    Vec3 point = Vec3::Zero(), way = Vec3::Zero();
    for (std::size_t k = 0; k < 3 && pressed.vertex[k] >= 0; ++k) {
      point += pressed.weight[k] * x.col(pressed.vertex[k]);
      way += pressed.weight[k] * (x.col(pressed.vertex[k]) - x_before.col(pressed.vertex[k]));
    }
    contact::Contact c;
    c.end_force = pressed.force - pressed.stiffness * pressed.normal.dot(way);
    if (!(c.end_force > 0.0)) continue;
    c.vertex = pressed.vertex;
    c.weight = pressed.weight;
    c.normal = pressed.normal;
    c.force = c.end_force * c.normal;
    c.point = point;
    contacts.contacts.push_back(c);
  }
}

void Grip::hold(const contact::Contacts& contacts, const contact::Patch& patch, const Points& x,
                const Vec3& on_hand, const contact::Pose& tool) {
  const std::vector<VertexForce> forces = find_vertex_forces(contacts);
  const double radius = std::max(patch.radius, find_radius(forces, x));
  const double stiffness = kStiffness * 2.0 * patch.modulus * radius;
  double sum = 0.0, squares = 0.0;
  Vec3 pressing = Vec3::Zero();
  for (const VertexForce& f : forces) {
    sum += f.force.norm();
    squares += f.force.squaredNorm();
    pressing += f.force;
  }
  // Friction is a part of it.
  const Vec3 missing = -on_hand - pressing;
  const Quat to_tool = tool.orientation.conjugate();
  m_state.bonds.clear();
  for (const auto& [vertex, force] : forces) {
    const double part = force.squaredNorm() / squares * stiffness;
    const Vec3 place = x.col(vertex) + (force + force.norm() / sum * missing) / part;
    m_state.bonds.push_back({vertex, to_tool * (place - tool.position), to_tool * force.normalized(), part});
  }
  m_state.area = std::numbers::pi * radius * radius;
  m_state.pressing_force = holds() ? std::max(0.0, -on_hand.dot(find_normal(tool))) : 0.0;
  m_state.answer = on_hand;
  m_state.centre = find_centre(tool);
  forget();
}

Vec3 Grip::find_normal(const contact::Pose& tool) const {
  Vec3 normal = Vec3::Zero();
  for (const Bond& bond : m_state.bonds) normal += bond.stiffness * bond.normal;
  return tool.orientation * normal.normalized();
}

Vec3 Grip::find_centre(const contact::Pose& tool) const {
  Vec3 centre = Vec3::Zero();
  double sum = 0.0;
  for (const Bond& bond : m_state.bonds) {
    sum += bond.stiffness;
    centre += bond.stiffness / sum * (bond.place - centre);
  }
  return place_in_world(tool, centre);
}

void Grip::go_on_from(const Grip& before, const Points& x_before, const Points& x,
                      const contact::Pose& tool) {
  m_state = before.m_state;
  forget();
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

/// As the force has changed on as long a way before it, whether the clay has flowed or not; farther, by a
/// half-space's stiffness under the patch.
Vec3 Grip::forecast(const Vec3& on_hand, const Vec3& centre, const Vec3& now) const {
  double stiffness = 0.0;
  for (const Bond& bond : m_state.bonds) stiffness += bond.stiffness / kStiffness;
  const Vec3 before = centre - m_state.centre;
  const Vec3 way = now - centre;
  const double length = before.squaredNorm();
  const double share = length > 0.0 ? std::clamp(way.dot(before) / length, 0.0, 1.0) : 0.0;
  return on_hand + share * (on_hand - m_state.answer) - stiffness * (way - share * before);
}

bool Grip::bears(const Vec3& on_hand, const Vec3& normal) const {
  const Vec3 pull = on_hand + std::max(0.0, -on_hand.dot(normal)) * normal;
  return pull.norm() <= m_strength * m_state.area;
}

void Grip::test(const Vec3& on_hand, const contact::Pose& tool, const contact::Pose& now) {
  if (!holds()) return;
  const Vec3 normal = find_normal(tool);
  if (-on_hand.dot(normal) > m_state.pressing_force) return release();
  const Vec3 centre = find_centre(tool);
  const Vec3 next = forecast(on_hand, centre, find_centre(now));
  m_state.answer = on_hand;
  m_state.centre = centre;
  if (bears(on_hand, normal) && bears(next, find_normal(now))) return;
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
  // One number says what follows, so that a state without a pull is none the larger.
  int phase = (m_state.has_let_go ? 1 : 0) + (m_state.pressed.empty() ? 0 : 2);
  archive.number("grip/has_let_go", phase);
  m_state.has_let_go = phase % 2 != 0;
  archive.number("grip/area", m_state.area);
  archive.number("grip/pressing_force", m_state.pressing_force);
  archive.records("grip/bonds", m_state.bonds, [](Bond& bond, auto field) {
    field(bond.vertex);
    for (double& value : bond.place) field(value);
    for (double& value : bond.normal) field(value);
    field(bond.stiffness);
  });
  if (holds()) {
    archive.array("grip/answer", m_state.answer);
    archive.array("grip/centre", m_state.centre);
  }
  if (archive.is_restoring()) m_state.pressed.clear();
  if (phase >= 2)
    archive.records("grip/pressed", m_state.pressed, [](Pressed& pressed, auto field) {
      for (int& vertex : pressed.vertex) field(vertex);
      for (double& weight : pressed.weight) field(weight);
      for (double& value : pressed.normal) field(value);
      field(pressed.force);
      field(pressed.stiffness);
    });
  if (archive.is_restoring()) commit();
}

}  // namespace argil::sim
