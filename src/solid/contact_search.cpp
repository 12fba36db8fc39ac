// Which contacts that are alone act in a step, and which of them slide.

#include "solid/contact_search.h"

#include <algorithm>
#include <cmath>

#include "solid/body.h"
#include "solid/product.h"
#include "solid/solve.h"

namespace argil::solid {
namespace {

constexpr int kMostRounds = 200;  // of a search
constexpr double kConeTolerance = 1e-3;
constexpr double kRounding = 1e-9;

/// Of what a contact would exert without a limit, what it does.
Vec3 limit_force(const PointStiffness& contact, double friction_limit, const Vec3& trial) {
  if (!(contact.friction > 0.0)) return contact.normal.dot(trial) > 0.0 ? trial : Vec3::Zero();
  const double length = trial.norm();
  return length > friction_limit ? Vec3(friction_limit / length * trial) : trial;
}

/// Limit of the friction of contact i where the contacts would exert these forces [N].
double find_limit(std::span<const PointStiffness> list, std::size_t i, const std::vector<Vec3>& trial) {
  const auto partner = static_cast<std::size_t>(list[i].partner);
  return list[i].friction * std::max(0.0, list[i].normal.dot(trial[partner]));
}

/// The same for the first guess of a step: of what its contact pressed with where the step begins. As a stiff
/// contact follows the tool, it would press with many times that if the body did not.
double find_first_limit(std::span<const PointStiffness> list, std::size_t i, const std::vector<Vec3>& trial) {
  const double begin = list[static_cast<std::size_t>(list[i].partner)].begin_force;
  return begin > 0.0 ? list[i].friction * begin : find_limit(list, i, trial);
}

/// As it acts from where it would carry `trial`; where it slides, as `slip` says.
Friction make_friction(const PointStiffness& contact, double limit, const Vec3& trial, Slip slip) {
  Friction friction;
  friction.limit = limit;
  const double length = trial.norm();
  if (length <= limit && limit > 0.0) return friction;
  friction.slip = slip;
  if (length == 0.0) return friction;
  const Vec3 along = trial / length;
  friction.across = contact.normal.cross(along);
  friction.stiffness = limit / length * contact.stiffness;
  if (slip == Slip::secant) {
    friction.force = limit / length * contact.force;
    return friction;
  }
  const double way = friction.across.dot(contact.force - trial) / contact.stiffness;
  friction.force = limit * along + friction.stiffness * way * friction.across;
  return friction;
}

/// What contact i exerts by the linear laws that a step was solved with, where it would exert `trial` without
/// limit.
Vec3 find_solved_force(const PointStiffness& contact, const ContactActivity& activity, std::size_t i,
                       const Vec3& trial) {
  if (!(contact.friction > 0.0)) return activity.acts[i] != 0 ? trial : Vec3::Zero();
  const Friction& friction = activity.friction[i];
  if (friction.slip == Slip::none) return trial;
  if (friction.slip == Slip::secant) return friction.stiffness / contact.stiffness * trial;
  const double way = friction.across.dot(contact.force - trial) / contact.stiffness;
  return friction.force - friction.stiffness * way * friction.across;
}

double limit_of(const ContactActivity& activity, std::size_t i) {
  return activity.friction.empty() ? 0.0 : activity.friction[i].limit;
}

/// Would a point that slides where it would exert `trial` slide back in the last solve, whose solution is
/// `solved`? One that was a secant there needs only begin to.
bool turns_back(const PointStiffness& contact, const Friction& friction, const Vec3& trial,
                const Vec3& solved) {
  constexpr double kBegins = 0.9;
  if (friction.slip == Slip::tangent) return friction.across.cross(contact.normal).dot(solved) < 0.0;
  return friction.slip == Slip::secant && solved.dot(trial) < kBegins * trial.squaredNorm();
}

/// As all would act from where they would exert `trial`. `of_turned`: how one slides that would slide back at
/// the last solution. Its force was as large however little it moved, so that tangents would go to and fro.
void choose(std::span<const PointStiffness> list, const std::vector<Vec3>& trial, Slip of_turned,
            ContactActivity& activity) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].friction > 0.0) {
      Friction& friction = activity.friction[i];
      const Slip slip =
          turns_back(list[i], friction, trial[i], activity.trial[i]) ? of_turned : Slip::tangent;
      friction = make_friction(list[i], friction.limit, trial[i], slip);
    } else if (list[i].is_alone) {
      activity.acts[i] = list[i].normal.dot(trial[i]) > 0.0 ? 1 : 0;
    }
}

void find_trials(const StepContacts& contacts, const Points& x, std::vector<Vec3>& trial) {
  trial.resize(contacts.list.size());
  for (std::size_t i = 0; i < trial.size(); ++i) trial[i] = contacts.compute_trial(i, x);
}

/// How far forces are from what they should be, and how large they are [N].
struct Misfit {
  double pressing = 0.0;
  double pressing_sum = 0.0;
  double friction = 0.0;
  double friction_sum = 0.0;
};

/// Of what the step was solved with at its solution. `with_new_limits`: friction's are those of what presses
/// there.
Misfit find_misfit(std::span<const PointStiffness> list, const ContactActivity& activity,
                   bool with_new_limits) {
  Misfit misfit;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const bool is_friction = list[i].friction > 0.0;
    if (!is_friction && !list[i].is_alone) continue;
    const Vec3& trial = activity.trial[i];
    const double limit =
        is_friction && with_new_limits ? find_limit(list, i, activity.trial) : limit_of(activity, i);
    const Vec3 right = limit_force(list[i], limit, trial);
    (is_friction ? misfit.friction : misfit.pressing) +=
        (right - find_solved_force(list[i], activity, i, trial)).norm();
    (is_friction ? misfit.friction_sum : misfit.pressing_sum) += is_friction ? limit : right.norm();
  }
  return misfit;
}

/// Limits go to those of what presses at the solution, so much of the way.
void move_limits(std::span<const PointStiffness> list, double share, ContactActivity& activity) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!(list[i].friction > 0.0)) continue;
    double& limit = activity.friction[i].limit;
    limit += share * (find_limit(list, i, activity.trial) - limit);
  }
}

void stand_at_solution(const Body& body, ContactActivity& activity) {
  activity.search.delta = body.system.delta;
  activity.search.trial = activity.trial;
}

/// Part of the way from where the search stands to the solution at which the potential is least. Where all
/// acts as at the start its slope is −c (1 − t) along δ.
double find_least(std::span<const PointStiffness> list, const ContactActivity& activity, double c) {
  const std::vector<Vec3>& start = activity.search.trial;
  const std::vector<Vec3>& end = activity.trial;
  const auto find_slope = [&](double t) {
    double slope = -c * (1.0 - t);
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!list[i].is_alone && !(list[i].friction > 0.0)) continue;
      const Vec3 change = end[i] - start[i];
      const Vec3 trial = start[i] + t * change;
      const Vec3 more =
          limit_force(list[i], limit_of(activity, i), trial) - find_solved_force(list[i], activity, i, trial);
      slope += more.dot(change) / list[i].stiffness;
    }
    return slope;
  };
  constexpr double kFarthest = 16.0;
  constexpr int kHalvings = 50;
  double low = 0.0;
  double high = 1.0;
  while (find_slope(high) < 0.0 && high < kFarthest) high *= 2.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double t = 0.5 * (low + high);
    (find_slope(t) < 0.0 ? low : high) = t;
  }
  return 0.5 * (low + high);
}

void go_to_least(Body& body, const Part& part, std::span<const PointStiffness> list) {
  ContactActivity& activity = body.contacts;
  Points& way = body.scratch.left;
  Points& delta = activity.search.delta;
  part.near_rows.each(body.model.num_free(), [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    const auto n = last - first;
    way.middleCols(first, n) = body.system.delta.middleCols(first, n) - delta.middleCols(first, n);
  });
  const double c = Product(body, part, list).multiply(way, body.scratch.correction);
  const double t = find_least(list, activity, c);
  part.near_rows.each(body.model.num_free(), [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    delta.middleCols(first, last - first) += t * way.middleCols(first, last - first);
  });
  for (std::size_t i = 0; i < list.size(); ++i)
    activity.search.trial[i] += t * (activity.trial[i] - activity.search.trial[i]);
}

/// The step ends at the least found so far, with the forces that contacts exert there: what they are off
/// Coulomb's law, or the body off its balance, is small beside them.
bool take_least(Body& body, const Part& part, std::span<const PointStiffness> list) {
  ContactActivity& activity = body.contacts;
  activity.search.has_given_up = true;
  body.system.delta = activity.search.delta;
  set_iterate(body, part, 1.0);
  activity.trial = activity.search.trial;
  choose(list, activity.trial, Slip::tangent, activity);
  return true;
}

/// The limits may follow what presses: what is off by those that there are is little beside what is off by
/// those that there should be; the less the more often they have.
bool is_least(const Misfit& misfit, const Misfit& of_cone, double pressing_tolerance, int num_updates) {
  constexpr int kFewUpdates = 3;
  const double little = num_updates < kFewUpdates ? 0.5 : 0.1;
  constexpr double kFrictionTolerance = 0.1 * kConeTolerance;
  const double of_cone_share = of_cone.friction_sum > 0.0 ? of_cone.friction / of_cone.friction_sum : 0.0;
  return misfit.pressing <= std::max(pressing_tolerance, little * of_cone_share) * misfit.pressing_sum &&
         misfit.friction <= std::max(kFrictionTolerance * misfit.friction_sum, little * of_cone.friction);
}

}  // namespace

void start_alone(std::span<const PointStiffness> contacts, const Points& v, double step_s,
                 ContactActivity& activity) {
  std::vector<Vec3>& trial = activity.trial;
  trial.resize(contacts.size());
  bool has_friction = false;
  const bool has_pressed = std::any_of(contacts.begin(), contacts.end(),
                                       [](const PointStiffness& c) { return c.begin_force > 0.0; });
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    trial[i] = contacts[i].force;
    has_friction = has_friction || contacts[i].friction > 0.0;
    if (contacts[i].is_alone)  // most of a body's way is that of the tool, so that few points come or go
      activity.acts[i] = (has_pressed ? contacts[i].begin_force > 0.0 : !contacts[i].is_near) ? 1 : 0;
  }
  if (!has_friction) return;
  activity.friction.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (contacts[i].friction > 0.0)
      activity.friction[i] =
          make_friction(contacts[i], find_first_limit(contacts, i, trial),
                        compute_trial(contacts[i], step_s * find_mean(contacts[i], v)), Slip::secant);
}

void choose_alone(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
  find_trials(contacts, x, activity.trial);
  choose(contacts.list, activity.trial, Slip::tangent, activity);
}

bool update_friction(const StepContacts& contacts, const Points& x, ContactActivity& activity) {
  constexpr int kMostUpdates = 30;  // of a step
  if (activity.friction.empty() || activity.num_updates++ >= kMostUpdates) return false;
  find_trials(contacts, x, activity.trial);
  const Misfit misfit = find_misfit(contacts.list, activity, true);
  if (misfit.friction <= kConeTolerance * misfit.friction_sum) return false;
  move_limits(contacts.list, 1.0, activity);
  choose(contacts.list, activity.trial, Slip::tangent, activity);
  return true;
}

double compute_potential_alone(const PointStiffness& contact, const Vec3& trial,
                               const ContactActivity& activity, std::size_t i) {
  if (!(contact.friction > 0.0))
    return 0.5 * std::pow(std::max(0.0, contact.normal.dot(trial)), 2) / contact.stiffness;
  const double limit = limit_of(activity, i);
  const double length = trial.norm();
  return (length > limit ? limit * (length - 0.5 * limit) : 0.5 * length * length) / contact.stiffness;
}

bool settle_contacts(Body& body, const Part& part, std::span<const PointStiffness> list, double tolerance) {
  if (!body.has_implicit_contact()) return true;
  const StepContacts contacts = body.step_contacts(list);
  ContactActivity& activity = body.contacts;
  if (!activity.are_alone) return !update_active_contacts(contacts, body.trial.x, activity);
  find_trials(contacts, body.trial.x, activity.trial);
  const double pressing_tolerance = std::max(kRounding, tolerance);
  const Misfit of_cone = find_misfit(list, activity, true);
  if (of_cone.pressing <= pressing_tolerance * of_cone.pressing_sum &&
      of_cone.friction <= kConeTolerance * of_cone.friction_sum)
    return true;
  ContactSearch& search = activity.search;
  if (search.num_rounds++ >= kMostRounds) {
    go_to_least(body, part, list);
    return take_least(body, part, list);
  }
  constexpr int kUpdatesInFull = 12;
  if (search.num_rounds == 1 ||
      is_least(find_misfit(list, activity, false), of_cone, pressing_tolerance, activity.num_updates)) {
    move_limits(list, ++activity.num_updates < kUpdatesInFull ? 1.0 : 0.5, activity);
    stand_at_solution(body, activity);
  } else {
    go_to_least(body, part, list);
  }
  choose(list, search.trial, Slip::secant, activity);
  return false;
}

}  // namespace argil::solid
