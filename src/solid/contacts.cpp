// Contacts in an implicit step: how their forces fall as the body yields, and which are let go.

#include "solid/contacts.h"

#include <cmath>

#include "solid/body.h"

namespace argil::solid {

void ContactActivity::start(std::size_t count) {
  acts.assign(count, 1);
  num_updates = 0;
}

Vec3 StepContacts::displacement(std::size_t i, const Points& x) const {
  const PointStiffness& contact = list[i];
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < contact.count(); ++k)
    mean += contact.weight[k] * (x.col(contact.vertex[k]) - x_start.col(contact.vertex[k]));
  return mean;
}

bool update_active_contacts(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
  constexpr int kRoundsWithReturn = 4;
  const bool may_return = ++activity.num_updates <= kRoundsWithReturn;
  activity.force.assign(contacts.list.size(), 0.0);
  for (std::size_t i = 0; i < contacts.list.size(); ++i) {
    const PointStiffness& c = contacts.list[i];
    if (c.group >= 0 && c.counts)
      activity.force[static_cast<std::size_t>(c.group)] +=
          c.normal.dot(c.force - c.stiffness * contacts.displacement(i, x));
  }
  bool has_changed = false;
  for (std::size_t i = 0; i < contacts.list.size(); ++i) {
    if (contacts.list[i].group != static_cast<int>(i)) continue;
    const bool acted = activity.acts[i] != 0;
    const bool acts = acted ? activity.force[i] >= 0.0 : may_return && activity.force[i] > 0.0;
    has_changed = has_changed || acts != acted;
    activity.acts[i] = acts ? 1 : 0;
  }
  return has_changed;
}

Vec3 StepContacts::compute_fall(std::size_t i, const Points& x, const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  if (!activity.is_acting(c.group)) return c.force;
  return c.stiffness * c.normal.dot(displacement(i, x)) * c.normal;
}

double StepContacts::compute_potential(std::size_t i, const Points& x,
                                       const ContactActivity& activity) const {
  const Vec3 u = displacement(i, x);
  if (!activity.is_acting(list[i].group)) return list[i].force.dot(u);
  return 0.5 * list[i].stiffness * std::pow(list[i].normal.dot(u), 2);
}

void add_contact_product(const StepContacts& contacts, const ContactActivity& activity, const Points& u,
                         double scale, Points& force) {
  for (const PointStiffness& c : contacts.list) {
    if (!activity.is_acting(c.group)) continue;
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < c.count(); ++k) mean += c.weight[k] * u.col(c.vertex[k]);
    spread(c, scale * c.stiffness * c.normal.dot(mean) * c.normal, force);
  }
}

void spread(const PointStiffness& contact, const Vec3& f, Points& force) {
  for (std::size_t i = 0; i < contact.count(); ++i) force.col(contact.vertex[i]) += contact.weight[i] * f;
}

Vec3 compute_contact_change(const Body& body, std::span<const PointStiffness> contacts, std::size_t i) {
  const SolidParams& params = body.model.params;
  if (!params.implicit_contact || body.is_explicit()) return Vec3::Zero();
  // Newmark's step takes the mean of both ends.
  const double share = params.integrator == Integrator::newmark ? 0.5 : 1.0;
  return -share * body.step_contacts(contacts).compute_fall(i, body.trial.x, body.contacts);
}

void apply_contact_stiffness(const Body& body, std::span<const PointStiffness> contacts, Points& force) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    spread(contacts[i], compute_contact_change(body, contacts, i), force);
}

}  // namespace argil::solid
