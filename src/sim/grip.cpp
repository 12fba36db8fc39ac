#include "sim/grip.h"

#include <algorithm>
#include <cmath>

namespace argil::sim {
namespace {

constexpr double kTouching = 0.05;  // gap of a point over its size, up to which it is part of the patch

Vec3 find_point(const std::array<int, 3>& vertex, const std::array<double, 3>& weight, const Points& x) {
  Vec3 point = Vec3::Zero();
  for (std::size_t k = 0; k < 3 && vertex[k] >= 0; ++k) point += weight[k] * x.col(vertex[k]);
  return point;
}

Vec3 place_in_world(const contact::Pose& tool, const Vec3& place) {
  return tool.position + tool.orientation * place;
}

}  // namespace

void Grip::hold(const contact::Contacts& contacts, const Vec3& on_hand, const contact::Pose& tool) {
  m_state.bonds.clear();
  const auto bond = [&](const contact::Contact& c, const Vec3& place, double stiffness) {
    const Quat to_tool = tool.orientation.conjugate();
    m_state.bonds.push_back(
        {c.vertex, c.weight, to_tool * (place - tool.position), to_tool * c.normal, stiffness, c.area});
  };
  for (const contact::Contact& c : contacts.contacts)
    if (c.end_stiffness > 0.0) bond(c, c.point + c.end_force / c.end_stiffness * c.normal, c.end_stiffness);
  for (const contact::Contact& c : contacts.near) {
    const double gap = -c.force.dot(c.normal) / c.stiffness;
    if (gap <= kTouching * std::sqrt(c.area)) bond(c, c.point, c.stiffness);
  }
  m_state.pressing_force = holds() ? std::max(0.0, -on_hand.dot(find_normal(tool))) : 0.0;
}

Vec3 Grip::find_normal(const contact::Pose& tool) const {
  Vec3 normal = Vec3::Zero();
  for (const Bond& bond : m_state.bonds) normal += bond.area * bond.normal;
  return tool.orientation * normal.normalized();
}

void Grip::test(const Vec3& on_hand, const contact::Pose& tool) {
  if (!holds()) return;
  const Vec3 normal = find_normal(tool);
  const double pressing = std::max(0.0, -on_hand.dot(normal));
  if (pressing > m_state.pressing_force) return release();
  double area = 0.0;
  for (const Bond& bond : m_state.bonds) area += bond.area;
  const Vec3 pull = on_hand + pressing * normal;
  if (pull.norm() <= m_strength * area) return;
  m_state.bonds.clear();
  m_state.has_let_go = true;
}

void Grip::find_contacts(const Points& x, const contact::Pose& from, const contact::Pose& to,
                         contact::Contacts& contacts) const {
  contacts.clear();
  for (const Bond& bond : m_state.bonds) {
    const Vec3 point = find_point(bond.vertex, bond.weight, x);
    const Vec3 end = place_in_world(to, bond.place) - point;
    const Vec3 mean = 0.5 * (place_in_world(from, bond.place) - point + end);
    contact::Contact c;
    c.vertex = bond.vertex;
    c.weight = bond.weight;
    c.normal = to.orientation * bond.normal;
    c.force = bond.stiffness * mean;
    c.stiffness = c.end_stiffness = c.spring = bond.stiffness;
    c.end_force = bond.stiffness * c.normal.dot(end);
    c.area = bond.area;
    c.point = point;
    contacts.contacts.push_back(c);
  }
  contacts.sum_reactions(to.position);
}

void Grip::serialize(Archive& archive) {
  archive.number("grip/has_let_go", m_state.has_let_go);
  archive.number("grip/pressing_force", m_state.pressing_force);
  archive.records("grip/bonds", m_state.bonds, [](Bond& bond, auto field) {
    for (int& vertex : bond.vertex) field(vertex);
    for (double& weight : bond.weight) field(weight);
    for (double& value : bond.place) field(value);
    for (double& value : bond.normal) field(value);
    field(bond.stiffness), field(bond.area);
  });
  if (archive.is_restoring()) commit();
}

}  // namespace argil::sim
