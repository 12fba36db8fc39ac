#include "sim/contact_load.h"

#include <cmath>

namespace argil::sim {

Vec3 find_inward(const contact::Contacts& contacts) {
  Vec3 inward = Vec3::Zero();
  for (const contact::Contact& c : list_touching(contacts)) inward += c.spring * c.normal;
  return inward.normalized();
}

ContactLoad::ContactLoad() {
  constexpr std::size_t kContacts = 16384;  // more than a late step gathers
  forces.reserve(kContacts);
  stiffness.reserve(kContacts);
  levers.reserve(kContacts);
  groups.reserve(kContacts);
}

void ContactLoad::clear() {
  cut_to({});
  touched_tet.clear();
  touched_area.clear();
}

void ContactLoad::cut_to(const Mark& mark) {
  patch = mark.patch;
  forces.resize(mark.forces);
  stiffness.resize(mark.stiffness);
  levers.resize(mark.stiffness);
  groups.resize(mark.groups);
  last_detection = mark.last_detection;
}

void ContactLoad::serialize(Archive& archive) {
  const auto numbers = [](auto& list, auto field) {
    for (auto& value : list) field(value);
  };
  archive.array("load/centre", patch.centre);
  archive.number("load/weight", patch.weight);
  archive.number("load/is_pressed", patch.is_pressed);
  archive.number("load/is_touched", patch.is_touched);
  archive.number("load/last_detection", last_detection);
  archive.records("load/forces", forces, [&](SurfaceForce& f, auto field) {
    numbers(f.vertex, field), numbers(f.weight, field), numbers(f.force, field);
  });
  archive.records("load/stiffness", stiffness, [&](solid::PointStiffness& s, auto field) {
    numbers(s.vertex, field), numbers(s.weight, field), numbers(s.normal, field), numbers(s.force, field);
    field(s.stiffness), field(s.group), field(s.counts);
  });
  archive.records("load/levers", levers, [&](ContactLever& lever, auto field) {
    numbers(lever.point, field), field(lever.force_at_rest);
  });
  archive.records("load/groups", groups, [&](ContactGroup& group, auto field) {
    numbers(group.vertex, field), field(group.first), field(group.pieces);
  });
}

LoadCollector::LoadCollector(const Params& params, const ContactSurface& surface,
                             const solid::Elements& elements)
    : m_params(params),
      m_surface(surface),
      m_elements(elements),
      m_share(params.detects_once_a_step() ? 1.0 : 1.0 / params.rates.physics_period_ticks) {}

void LoadCollector::begin_detection(double way_over_patch, const PatchResolution& resolution) {
  m_load.way_over_patch = way_over_patch;
  m_load.resolution = resolution;
  m_load.patch.is_pressed = false;
  m_load.patch.centre.setZero();
  m_load.patch.weight = 0.0;
}

void LoadCollector::add_force(const contact::Contact& c, const Vec3& force) {
  ContactPatch& patch = m_load.patch;
  patch.is_touched = true;
  m_load.forces.push_back({c.vertex, c.weight, m_share * force});
  // The centre of pressure so far.
  const double weight = force.norm();
  patch.weight += weight;
  patch.is_pressed = patch.weight > 0.0;
  if (weight > 0.0) patch.centre += weight / patch.weight * (c.point - patch.centre);
}

void LoadCollector::add_reaction(const SurfaceForce& force) {
  m_load.patch.is_touched = true;
  m_load.forces.push_back(force);
}

/// The force falls by the contact's stiffness, by damping with the speed, and along the surface while it
/// sticks, or across its path where it slides. One that pushes lets go before it would draw. A pulling
/// contact has negative stiffness; left out, so that the system stays positive definite.
int LoadCollector::add_stiffness(const contact::Contact& c, const Vec3& force, bool pushes, const Points& x) {
  // The damping force counted with the body's last speed; the solve finds the next, from a force without it.
  const double per_speed = c.damping / (m_params.rates.physics_period_ticks * m_params.rates.haptic_period);
  const double at_rest = c.damping * c.body_speed;
  const std::size_t first = m_load.stiffness.size();
  add_stiffness_along(c, c.normal, m_share * ((pushes ? c.stiffness : 0.0) + per_speed), m_share * at_rest,
                      x);
  const std::size_t pieces = m_load.stiffness.size() - first;
  const std::size_t leader = pushes && pieces > 0 ? find_group(c, first, pieces) : 0;
  for (std::size_t i = 0; pushes && i < pieces; ++i) {
    solid::PointStiffness& piece = m_load.stiffness[first + i];
    piece.force =
        (pieces == 1 ? 1.0 : c.weight[i]) * force + m_load.levers[first + i].force_at_rest * c.normal;
    piece.group = static_cast<int>(leader + i);
    piece.counts = true;
  }
  const int group = pieces > 0 ? m_load.stiffness[first].group : -1;
  if (c.sticking == 0.0) return group;
  const bool slides = c.sticking < 0.0;
  const Vec3 dragged = c.resistance - c.normal.dot(c.resistance) * c.normal;
  const Vec3 along = slides ? dragged.normalized() : c.normal.unitOrthogonal();
  const std::array<Vec3, 2> directions = {c.normal.cross(along), along};
  for (std::size_t d = 0; d < (slides ? 1 : 2); ++d) {
    const std::size_t begin = m_load.stiffness.size();
    add_stiffness_along(c, directions[d], m_share * std::abs(c.sticking), 0.0, x);
    for (std::size_t i = 0; pushes && i < pieces; ++i)
      m_load.stiffness[begin + i].group = static_cast<int>(leader + i);
  }
  return group;
}

void LoadCollector::add_pressure(const contact::Contact& c, bool is_near, const Points& x) {
  const std::size_t first = m_load.stiffness.size();
  add_stiffness_along(c, c.normal, m_share * c.stiffness, 0.0, x);
  const std::size_t end = m_load.stiffness.size();
  const auto part = [&](std::size_t i) { return m_share * (end - first == 1 ? 1.0 : c.weight[i - first]); };
  for (std::size_t i = first; i < end; ++i) {
    solid::PointStiffness& entry = m_load.stiffness[i];
    entry.force = part(i) * c.force;
    entry.group = static_cast<int>(i);
    entry.counts = entry.is_alone = true;
    entry.is_near = is_near;
    entry.begin_force = part(i) * c.begin_force;
  }
  for (std::size_t i = first; c.friction > 0.0 && i < end; ++i) {
    solid::PointStiffness entry = m_load.stiffness[i];
    entry.counts = entry.is_alone = false;
    entry.group = -1;
    entry.friction = c.friction;
    entry.partner = static_cast<int>(i);
    entry.force = part(i) * c.resistance;
    m_load.stiffness.push_back(entry);
    m_load.levers.push_back({m_load.levers[i].point, 0.0});
  }
}

void LoadCollector::serialize(Archive& archive) {
  m_load.serialize(archive);
  if (m_params.contact.law != contact::ContactLaw::pressure) return;
  archive.records("load/pressure", m_load.stiffness, [](solid::PointStiffness& s, auto field) {
    field(s.is_alone), field(s.begin_force), field(s.is_near), field(s.friction), field(s.partner);
  });
}

void LoadCollector::add_bond(const contact::Contact& bond, const Points& x) {
  const Vec3 along = bond.normal.unitOrthogonal();
  for (const Vec3& direction : {bond.normal, along, Vec3(bond.normal.cross(along))})
    add_stiffness_along(bond, direction, m_share * bond.stiffness, 0.0, x);
}

/// What presses on the same vertices in several ticks of a step is one contact to the body, which gets the
/// mean. Number of the first piece of the first of them, or `first` when there was none yet.
std::size_t LoadCollector::find_group(const contact::Contact& c, std::size_t first, std::size_t pieces) {
  for (const ContactGroup& group : m_load.groups)
    if (group.vertex == c.vertex && group.pieces == pieces) return group.first;
  m_load.groups.push_back({c.vertex, first, pieces});
  return first;
}

void LoadCollector::add_stiffness_along(const contact::Contact& c, const Vec3& direction, double stiffness,
                                        double force_at_rest, const Points& x) {
  if (!(stiffness > 0.0)) return;
  m_surface.add_stiffness(c, direction, stiffness, m_elements, m_load.stiffness);
  if (!m_params.solid.solves_contact()) force_at_rest = 0.0;
  if (force_at_rest != 0.0) m_load.forces.push_back({c.vertex, c.weight, force_at_rest * direction});
  // One entry stands for the contact as a whole, more of them for one of its vertices each.
  const std::size_t added = m_load.stiffness.size() - m_load.levers.size();
  for (std::size_t i = 0; i < added; ++i)
    m_load.levers.push_back(added == 1 ? ContactLever{c.point, force_at_rest}
                                       : ContactLever{x.col(c.vertex[i]), c.weight[i] * force_at_rest});
}

/// Where there is one detection a step, it counts as it is; otherwise each tick's contacts count with the
/// share that they have in a step of the planned length, which is set right here where it was shorter or
/// longer.
void LoadCollector::hand_over(const HandPose& hand, device::ToolMode mode, int num_ticks,
                              const contact::Contacts& contacts, ContactLoad& load) {
  const int planned = m_params.rates.physics_period_ticks;
  const bool once = m_params.detects_once_a_step();
  m_load.hand = hand;
  m_load.num_ticks = num_ticks;
  m_load.scale = once || num_ticks == planned ? 1.0 : static_cast<double>(planned) / num_ticks;
  m_load.detections = once ? 1 : num_ticks;
  m_load.mode = mode;
  m_load.inward = find_inward(contacts);
  if (m_load.scale != 1.0) {
    for (solid::PointStiffness& entry : m_load.stiffness) {
      entry.stiffness *= m_load.scale;
      entry.force *= m_load.scale;
      entry.begin_force *= m_load.scale;
    }
    for (ContactLever& entry : m_load.levers) entry.force_at_rest *= m_load.scale;
  }
  if (contacts.with_touched) m_surface.find_touched_tets(contacts, m_load.touched_tet, m_load.touched_area);
  load.clear();
  std::swap(m_load, load);
}

}  // namespace argil::sim
