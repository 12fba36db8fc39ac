// Contacts in an implicit step: how their forces fall as the body yields, and which are let go.

#include <cmath>

#include "solid/solid.h"

namespace argil::solid {

void Solid::start_contacts(std::size_t count) {
  m_contact_acts.assign(count, 1);
  m_contact_exchanges = 0;
}

/// Lets go what would draw at the present iterate and takes back what would press again: Newton's method on
/// the potential ½ Σ max(0, n·f − k n·(x − x₀))²/k, which is convex. After some rounds contacts are only let
/// go, so that this ends. False when all is as it was.
bool Solid::exchange_contacts(std::span<const PointStiffness> contacts) {
  if (m_is_static || is_explicit() || !m_params.implicit_contact) return false;
  constexpr int kRoundsWithReturn = 4;
  const bool may_return = ++m_contact_exchanges <= kRoundsWithReturn;
  m_contact_force.assign(contacts.size(), 0.0);
  for (const PointStiffness& c : contacts)
    if (c.group >= 0 && c.counts)
      m_contact_force[static_cast<std::size_t>(c.group)] +=
          c.normal.dot(c.force - c.stiffness * compute_mean_way(c, m_x, m_x_start));
  bool has_changed = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].group != static_cast<int>(i)) continue;
    const bool acted = m_contact_acts[i] != 0;
    const bool acts = acted ? m_contact_force[i] >= 0.0 : may_return && m_contact_force[i] > 0.0;
    has_changed = has_changed || acts != acted;
    m_contact_acts[i] = acts ? 1 : 0;
  }
  return has_changed;
}

/// How much less than f a contact exerts at the present iterate [N].
Vec3 Solid::compute_contact_fall(std::span<const PointStiffness> contacts, std::size_t i) const {
  const PointStiffness& c = contacts[i];
  if (!acts(c.group)) return c.force;
  return c.stiffness * c.normal.dot(compute_mean_way(c, m_x, m_x_start)) * c.normal;
}

Vec3 Solid::compute_contact_change(std::span<const PointStiffness> contacts, std::size_t i) const {
  if (!m_params.implicit_contact || is_explicit()) return Vec3::Zero();
  // Newmark's step takes the mean of both ends.
  const double share = m_params.integrator == Integrator::newmark ? 0.5 : 1.0;
  return -share * compute_contact_fall(contacts, i);
}

void Solid::apply_contact_stiffness(std::span<const PointStiffness> contacts, Points& force) const {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    spread(contacts[i], compute_contact_change(contacts, i), force);
}

/// scale · Σ k n n·u of the contacts that act.
void Solid::add_contact_product(const Points& u, std::span<const PointStiffness> contacts, double scale,
                                Points& force) const {
  for (const PointStiffness& c : contacts) {
    if (!acts(c.group)) continue;
    spread(c, scale * c.stiffness * c.normal.dot(compute_mean_way(c, u, m_zero)) * c.normal, force);
  }
}

/// Potential of what compute_contact_fall is the force of [J].
double Solid::compute_contact_potential(std::span<const PointStiffness> contacts, std::size_t i) const {
  const Vec3 way = compute_mean_way(contacts[i], m_x, m_x_start);
  if (!acts(contacts[i].group)) return contacts[i].force.dot(way);
  return 0.5 * contacts[i].stiffness * std::pow(contacts[i].normal.dot(way), 2);
}

void Solid::spread(const PointStiffness& contact, const Vec3& f, Points& force) {
  for (std::size_t i = 0; i < contact.count(); ++i) force.col(contact.vertex[i]) += contact.weight[i] * f;
}

Vec3 Solid::compute_mean_way(const PointStiffness& contact, const Points& to, const Points& from) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < contact.count(); ++i)
    mean += contact.weight[i] * (to.col(contact.vertex[i]) - from.col(contact.vertex[i]));
  return mean;
}

}  // namespace argil::solid
