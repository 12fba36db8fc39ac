// Contacts in an implicit step: how their forces fall as the body yields, and which are let go.

#include "solid/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid/body.h"
#include "solid/contact_search.h"

namespace argil::solid {

void ContactActivity::start(std::span<const PointStiffness> contacts, const Points& v, double step_s) {
  acts.assign(contacts.size(), 1);
  go_on();
  are_alone = std::all_of(contacts.begin(), contacts.end(),
                          [](const PointStiffness& c) { return c.group < 0 || c.is_alone; });
  friction.clear();
  if (are_alone) start_alone(contacts, v, step_s, *this);
}

Vec3 find_mean(const PointStiffness& contact, const Points& u) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < contact.count(); ++k) mean += contact.weight[k] * u.col(contact.vertex[k]);
  return mean;
}

Vec3 compute_trial(const PointStiffness& contact, const Vec3& u) {
  const Vec3 trial = contact.force - contact.stiffness * u;
  const Vec3 pressing = contact.normal.dot(trial) * contact.normal;
  return contact.friction > 0.0 ? Vec3(trial - pressing) : pressing;
}

Vec3 StepContacts::displacement(std::size_t i, const Points& x) const {
  const PointStiffness& contact = list[i];
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < contact.count(); ++k)
    mean += contact.weight[k] * (x.col(contact.vertex[k]) - x_start.col(contact.vertex[k]));
  return mean;
}

Vec3 StepContacts::compute_trial(std::size_t i, const Points& x) const {
  return solid::compute_trial(list[i], displacement(i, x));
}

bool update_active_contacts(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
  constexpr int kUpdatesWithReturn = 4;
  const bool may_return = ++activity.num_updates <= kUpdatesWithReturn;
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

Mat3 StepContacts::stiffness(std::size_t i, const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  if (!(c.friction > 0.0)) return c.stiffness * c.normal * c.normal.transpose();
  const Friction& friction = activity.friction[i];
  if (friction.slip == Slip::tangent)
    return friction.stiffness * friction.across * friction.across.transpose();
  const double stiffness = friction.slip == Slip::secant ? friction.stiffness : c.stiffness;
  return stiffness * (Mat3::Identity() - c.normal * c.normal.transpose());
}

Vec3 StepContacts::compute_fall(std::size_t i, const Points& x, const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  const Vec3 not_given = c.is_near ? c.force : Vec3::Zero();
  if (!activity.is_acting(c.group)) return c.force - not_given;
  if (c.friction > 0.0) {
    const Vec3 fall = stiffness(i, activity) * displacement(i, x);
    const Friction& friction = activity.friction[i];
    return (friction.slip == Slip::none ? fall : Vec3(c.force - friction.force + fall)) - not_given;
  }
  return c.stiffness * c.normal.dot(displacement(i, x)) * c.normal - not_given;
}

double StepContacts::compute_potential(std::size_t i, const Points& x,
                                       const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  const Vec3 u = displacement(i, x);
  if (activity.are_alone && (c.is_alone || c.friction > 0.0)) {
    const double given = c.is_near ? 0.0 : c.force.dot(u);
    return compute_potential_alone(c, compute_trial(i, x), activity, i) + given;
  }
  if (!activity.is_acting(c.group)) return c.force.dot(u);
  return 0.5 * c.stiffness * std::pow(c.normal.dot(u), 2);
}

void add_contact_product(const StepContacts& contacts, const ContactActivity& activity, const Points& u,
                         double scale, Points& force) {
  for (std::size_t i = 0; i < contacts.list.size(); ++i) {
    const PointStiffness& c = contacts.list[i];
    if (!activity.is_acting(c.group)) continue;
    const Vec3 mean = find_mean(c, u);
    if (c.friction > 0.0)
      spread(c, scale * (contacts.stiffness(i, activity) * mean), force);
    else
      spread(c, scale * c.stiffness * c.normal.dot(mean) * c.normal, force);
  }
}

void spread(const PointStiffness& contact, const Vec3& f, Points& force) {
  for (std::size_t i = 0; i < contact.count(); ++i) force.col(contact.vertex[i]) += contact.weight[i] * f;
}

Vec3 compute_contact_change(const Body& body, std::span<const PointStiffness> contacts, std::size_t i) {
  const SolidParams& params = body.model.params;
  if (!params.implicit_contact || body.is_explicit()) return Vec3::Zero();
  return -body.step_contacts(contacts).compute_fall(i, body.trial.x, body.contacts);
}

double find_contact_norm(Body& body, std::span<const PointStiffness> contacts) {
  Points& force = body.scratch.product;
  const auto each_node = [&](auto call) {
    for (const PointStiffness& contact : contacts)
      for (std::size_t k = 0; k < contact.count(); ++k) call(contact.vertex[k]);
  };
  each_node([&](int n) { force.col(n).setZero(); });
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 given = contacts[i].is_near ? Vec3(Vec3::Zero()) : contacts[i].force;
    spread(contacts[i], given + compute_contact_change(body, contacts, i), force);
  }
  constexpr double kCounted = std::numeric_limits<double>::infinity();
  double now = 0.0, before = 0.0;
  each_node([&](int n) {
    if (force(0, n) == kCounted) return;
    now += force.col(n).squaredNorm();
    before += body.forces.internal.col(n).squaredNorm();
    force(0, n) = kCounted;
  });
  each_node([&](int n) { force.col(n).setZero(); });
  return std::sqrt(std::max(now, before));
}

void apply_contact_stiffness(const Body& body, std::span<const PointStiffness> contacts, Points& force) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    spread(contacts[i], compute_contact_change(body, contacts, i), force);
}

}  // namespace argil::solid
