// Contacts in an implicit step: how their forces fall as the body yields, and which are let go.

#include "solid/contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solid/body.h"

namespace argil::solid {

namespace {

constexpr int kRoundsWithReturn = 4;   // in which contacts that were let go may come back
constexpr int kRoundsOfFriction = 30;  // in which the limits of friction may follow what presses
constexpr double kConeTolerance = 1e-3;

bool has_friction(std::span<const PointStiffness> contacts) {
  return std::any_of(contacts.begin(), contacts.end(),
                     [](const PointStiffness& c) { return c.friction > 0.0; });
}

/// What of the friction at `contact` a slip carries that a spring would carry with the force `trial`.
Sliding make_sliding(const PointStiffness& contact, const Vec3& trial, double limit,
                     const Vec3& displacement) {
  const double length = trial.norm();
  const Vec3 along = trial / length;
  Sliding sliding{true, limit * along, contact.normal.cross(along), limit / length * contact.stiffness};
  sliding.force += sliding.stiffness * sliding.across.dot(displacement) * sliding.across;
  return sliding;
}

/// Sticks or slides every contact with friction anew. False where all carried what they may, but for the
/// tolerance: then they stay as the step was solved with them.
bool update_sliding(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
  double error = 0.0;
  double sum = 0.0;
  activity.next.resize(activity.sliding.size());
  for (std::size_t i = 0; i < contacts.list.size(); ++i) {
    const PointStiffness& c = contacts.list[i];
    if (!(c.friction > 0.0) || !activity.is_acting(c.group)) continue;
    const PointStiffness& partner = contacts.list[static_cast<std::size_t>(c.partner)];
    const Vec3 u = contacts.displacement(i, x);
    const double limit = c.friction * std::max(0.0, c.normal.dot(partner.force - partner.stiffness * u));
    const Vec3 trial = c.force - c.stiffness * (u - c.normal.dot(u) * c.normal);
    const Vec3 carried = c.force - contacts.compute_fall(i, x, activity);
    Sliding& sliding = activity.next[i];
    sliding = trial.norm() > limit ? make_sliding(c, trial, limit, u) : Sliding{};
    const Vec3 right = sliding.is_sliding ? Vec3(limit / trial.norm() * trial) : trial;
    error += (right - carried).norm();
    sum += limit;
  }
  if (error <= kConeTolerance * sum) return false;
  std::swap(activity.sliding, activity.next);
  return true;
}

}  // namespace

void ContactActivity::start(std::span<const PointStiffness> contacts) {
  acts.assign(contacts.size(), 1);
  num_updates = 0;
  sliding.clear();
  if (!has_friction(contacts)) return;
  sliding.resize(contacts.size());
}

Mat3 StepContacts::stiffness(std::size_t i, const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  if (!(c.friction > 0.0)) return c.stiffness * c.normal * c.normal.transpose();
  const Sliding& sliding = activity.sliding[i];
  if (sliding.is_sliding) return sliding.stiffness * sliding.across * sliding.across.transpose();
  return c.stiffness * (Mat3::Identity() - c.normal * c.normal.transpose());
}

Vec3 StepContacts::displacement(std::size_t i, const Points& x) const {
  const PointStiffness& contact = list[i];
  Vec3 mean = Vec3::Zero();
  for (std::size_t k = 0; k < contact.count(); ++k)
    mean += contact.weight[k] * (x.col(contact.vertex[k]) - x_start.col(contact.vertex[k]));
  return mean;
}

bool update_active_contacts(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
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
  if (activity.sliding.empty() || activity.num_updates > kRoundsOfFriction) return has_changed;
  return update_sliding(contacts, x, activity) || has_changed;
}

Vec3 StepContacts::compute_fall(std::size_t i, const Points& x, const ContactActivity& activity) const {
  const PointStiffness& c = list[i];
  if (!activity.is_acting(c.group)) return c.force;
  if (c.friction > 0.0) {
    const Vec3 fall = stiffness(i, activity) * displacement(i, x);
    const Sliding& sliding = activity.sliding[i];
    return sliding.is_sliding ? Vec3(c.force - sliding.force + fall) : fall;
  }
  return c.stiffness * c.normal.dot(displacement(i, x)) * c.normal;
}

double StepContacts::compute_potential(std::size_t i, const Points& x,
                                       const ContactActivity& activity) const {
  const Vec3 u = displacement(i, x);
  if (!activity.is_acting(list[i].group)) return list[i].force.dot(u);
  if (list[i].friction > 0.0) {
    const double spring = 0.5 * u.dot(stiffness(i, activity) * u);
    const Sliding& sliding = activity.sliding[i];
    return sliding.is_sliding ? spring + (list[i].force - sliding.force).dot(u) : spring;
  }
  return 0.5 * list[i].stiffness * std::pow(list[i].normal.dot(u), 2);
}

void add_contact_product(const StepContacts& contacts, const ContactActivity& activity, const Points& u,
                         double scale, Points& force) {
  for (std::size_t i = 0; i < contacts.list.size(); ++i) {
    const PointStiffness& c = contacts.list[i];
    if (!activity.is_acting(c.group)) continue;
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < c.count(); ++k) mean += c.weight[k] * u.col(c.vertex[k]);
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
  // Newmark's step takes the mean of both ends.
  const double share = params.integrator == Integrator::newmark ? 0.5 : 1.0;
  return -share * body.step_contacts(contacts).compute_fall(i, body.trial.x, body.contacts);
}

void apply_contact_stiffness(const Body& body, std::span<const PointStiffness> contacts, Points& force) {
  for (std::size_t i = 0; i < contacts.size(); ++i)
    spread(contacts[i], compute_contact_change(body, contacts, i), force);
}

}  // namespace argil::solid
