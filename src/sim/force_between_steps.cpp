#include "sim/force_between_steps.h"

#include <algorithm>
#include <cmath>

#include "contact/nearest.h"

namespace argil::sim {
namespace {

/// Of K on a half-space along its surface [Mindlin1949]: 2 (1 − ν)/(2 − ν), 0.82 for ν = 0.3.
constexpr double kAlongSurface = 0.8;

/// Where a place that was `point` with the tool at `from` has gone with it.
Vec3 carry(const Vec3& point, const contact::Pose& from, const contact::Pose& to) {
  return to.position + to.orientation * (from.orientation.conjugate() * (point - from.position));
}

/// Coefficient of the patch as a whole, whose answer was these forces: on a round patch pressures add up to
/// less than their sum, on a hemisphere to half of it, and friction is a share of each.
double find_friction(double coefficient, const Vec3& along, double pressing) {
  constexpr double kHemisphere = 2.0;
  if (!(along.norm() > coefficient * pressing)) return coefficient;
  return std::min(kHemisphere * coefficient, along.norm() / std::max(pressing, 0.0));
}

}  // namespace

ForceBetweenSteps::ForceBetweenSteps(const RateParams& rates, double lag)
    : m_period(rates.haptic_period), m_planned(rates.physics_period_ticks), m_lag(lag) {}

void ForceBetweenSteps::begin_at(const contact::Pose& tool) {
  m_state.told.tool = m_state.place.tool = tool;
  commit();
}

void ForceBetweenSteps::tell(const contact::Contacts& contacts, const contact::Patch& patch,
                             const contact::Pose& from, const contact::Pose& to) {
  Place& told = m_state.told;
  told = {};
  told.tool = {to.position + m_lag * (from.position - to.position),
               to.orientation.slerp(m_lag, from.orientation)};
  told.centre = told.tool.position;
  Vec3 centre = Vec3::Zero();
  const std::vector<contact::Contact>& list = list_touching(contacts);
  for (const contact::Contact& c : list) {
    told.springs += c.spring;
    centre += c.spring * c.point;
  }
  if (!(told.springs > 0.0)) return;
  told.modulus = patch.modulus;
  told.cell = patch.cell;
  told.centre = carry(centre / told.springs, to, told.tool);
  told.outward = -find_inward(contacts);
  told.has_passed = !contacts.contacts.empty() && (to.position - from.position).dot(told.outward) < 0.0 &&
                    std::all_of(list.begin(), list.end(), [](const contact::Contact& c) { return c.passes; });
  m_state.shares.clear();
  for (const contact::Contact& c : list)
    m_state.shares.push_back({c.vertex, c.weight, Vec3::Constant(c.spring / told.springs)});
}

void ForceBetweenSteps::go_on_from(const ForceBetweenSteps& before, const Points& x_before, const Points& x) {
  m_state = before.m_state;
  for (SurfaceForce& share : m_state.shares)
    for (int& v : share.vertex)
      if (v >= 0) v = contact::find_nearest_point(x, x_before.col(v));
  commit();
}

/// A quarter of the debt a step: with more, a force that comes to rest would swing. There the debt of a step
/// is its change, so that of what is off, z² − z + β = 0 remains from step to step.
void ForceBetweenSteps::repay(bool has_left, LoadCollector& load) {
  constexpr double kPart = 0.25;        // β
  constexpr double kNegligible = 1e-9;  // of what the hand feels
  if (m_state.owed.isZero(0.0) || m_state.shares.empty()) return;
  const double step_s = m_planned * m_period;
  const bool all = has_left || m_state.owed.norm() < kNegligible * step_s * m_state.answer.force.norm();
  const Vec3 given = all ? m_state.owed : Vec3(kPart * m_state.owed);
  m_state.owed = all ? Vec3(Vec3::Zero()) : Vec3(m_state.owed - given);
  for (const SurfaceForce& share : m_state.shares)
    load.add_reaction({share.vertex, share.weight, share.force.cwiseProduct(-given / step_s)});
}

double ForceBetweenSteps::ticks_ahead() const {
  return 0.5 * (m_planned - 1) + m_planned * m_lag;
}

/// Where the force grows steadily from answer to answer, by ΔF, the hand has felt (½(N − 1) + N·lag) ΔF more
/// in N ticks than that: that the body gets with the next one.
void ForceBetweenSteps::receive(const device::Wrench& answer, const Vec3& friction,
                                const PressedPatch& pressed) {
  // A body that was told of nothing has got nothing: a tool under which it keeps its shape is felt all the
  // same.
  const device::Wrench given = m_state.told.springs > 0.0 ? answer : device::Wrench{};
  m_state.owed += m_period * (m_state.excess + (m_state.ticks - m_planned) * m_state.answer.force) +
                  ticks_ahead() * m_period * (m_state.answer.force - given.force);
  m_state.excess.setZero();
  m_state.ticks = 0;
  m_state.answer = given;
  m_state.friction = friction;
  m_state.place = m_state.told;
  Place& place = m_state.place;
  find_stiffness(pressed);
  if (given.force.isZero(0.0)) place.outward.setZero();
  const Vec3 pressure = given.force - friction;
  if (presses() && pressure.dot(place.outward) > 0.0)
    place.outward = pressure.normalized();  // so that of pressure nothing is along the surface
}

void ForceBetweenSteps::find_stiffness(const PressedPatch& pressed) {
  Place& place = m_state.place;
  const Vec3& n = place.outward;
  const double springs = pressed.springs > 0.0 ? pressed.springs : place.springs;
  const double half_space = pressed.find_half_space_stiffness(place.modulus, place.cell);
  const double known = n.dot(pressed.compliance * n);
  const double compliance = known > 0.0 || half_space == 0.0 ? known : 1.0 / half_space;
  place.drift = pressed.drift;
  place.give = half_space > 0.0 ? std::max(0.0, compliance - 1.0 / half_space) : compliance;
  if (place.has_passed) place.stiffness = 0.0;
  if (place.has_passed || !(compliance > 0.0) || !(springs > 0.0)) return;
  place.stiffness = 1.0 / (compliance + 1.0 / springs);
  if (known > 0.0) place.sideways = (pressed.compliance + Mat3::Identity() / springs).inverse();
}

/// At the end of the step receive() takes this answer for what the body got in N ticks and what the hand felt
/// from the first on. Until now it was the old one.
void ForceBetweenSteps::change_answer(const device::Wrench& answer, const Vec3& friction) {
  m_state.excess += (m_planned - m_state.ticks - ticks_ahead()) * (answer.force - m_state.answer.force);
  m_state.answer = answer;
  m_state.friction = friction;
}

bool ForceBetweenSteps::may_be_unpressed(const contact::Pose& tool) const {
  constexpr double kGrown = 4.0;
  if (!presses() || !knows_stiffness()) return true;
  const double answered = m_state.place.outward.dot(m_state.answer.force - m_state.friction);
  return find_pressing(tool) > kGrown * answered;
}

/// With the body's give c in series: where it would be f at the depth d, it is f ((d − c s f)/d)^{3/2} = s f,
/// with d = 3/2 f/k. Newton's method comes down to s, and ends where it does not.
Vec3 ForceBetweenSteps::find_force(const Unpressed& unpressed) const {
  constexpr double kExponent = 1.5;
  constexpr double kClose = 1e-12;
  const double give = unpressed.stiffness * m_state.place.give / kExponent;
  double root = 1.0;  // s^{1/3}, from above: r² + give r³ = 1
  for (double change = 1.0; change > kClose * root;) {
    change = (root * root * (1.0 + give * root) - 1.0) / (root * (2.0 + 3.0 * give * root));
    root -= change;
  }
  return root * root * root * unpressed.force;
}

void ForceBetweenSteps::compare(const Unpressed& unpressed) {
  Place& place = m_state.place;
  if (!knows_stiffness()) place.stiffness = unpressed.stiffness;
  const double answered = std::max(0.0, place.outward.dot(m_state.answer.force - m_state.friction));
  const double force = place.outward.dot(find_force(unpressed));
  place.share = force > answered ? answered / force : 1.0;
}

/// Of the tool's place on the body, less that of the body by itself [m].
Vec3 ForceBetweenSteps::find_way(const contact::Pose& tool) const {
  const Place& place = m_state.place;
  const double share = std::min(1.0, static_cast<double>(m_state.ticks) / m_planned);
  return carry(place.centre, place.tool, tool) - place.centre - share * place.drift;
}

/// Along the patch's normal; negative where the tool would draw.
double ForceBetweenSteps::find_pressing(const contact::Pose& tool) const {
  const Place& place = m_state.place;
  return place.outward.dot(m_state.answer.force - m_state.friction - place.stiffness * find_way(tool));
}

/// By a way along the surface, while what presses keeps its force.
Vec3 ForceBetweenSteps::find_growth_along(const Vec3& way) const {
  const Place& place = m_state.place;
  if (place.sideways.isZero(0.0)) return -kAlongSurface * place.stiffness * way;
  const Vec3 normal = place.sideways * place.outward;
  const Vec3 along = place.sideways * way;
  return place.outward.dot(along) / place.outward.dot(normal) * normal - along;
}

device::Wrench ForceBetweenSteps::forecast(const contact::Pose& tool, const Limits& limits) const {
  const Place& place = m_state.place;
  if (!presses()) {
    // A long tool that goes through a thin part is nearer to the far side in the end.
    const Vec3 force = find_force(limits.unpressed);
    const bool pushes_on = force.dot(tool.position - place.tool.position) > 0.0;
    return {pushes_on ? Vec3(Vec3::Zero()) : force, Vec3::Zero()};
  }
  const Vec3& n = place.outward;
  const Vec3 way = find_way(tool);
  const Vec3 answered = m_state.answer.force - m_state.friction;
  Vec3 force = m_state.answer.force - place.sideways * way;
  if (!limits.holds || place.sideways.isZero(0.0)) {
    double pressing = find_pressing(tool);
    const Vec3 along_answered = m_state.answer.force - n.dot(answered) * n;
    Vec3 along = along_answered;
    if (limits.holds || limits.friction > 0.0) along += find_growth_along(way - n.dot(way) * n);
    if (!limits.holds) {
      pressing = std::max({0.0, pressing, place.share * n.dot(find_force(limits.unpressed))});
      const double most = find_friction(limits.friction, along_answered, n.dot(answered)) * pressing;
      if (const double length = along.norm(); length > most) along *= most / length;
    }
    force = pressing * n + along;
  }
  return {force, m_state.answer.torque + (place.centre - tool.position).cross(force - m_state.answer.force)};
}

void ForceBetweenSteps::feel(const Vec3& force) {
  ++m_state.ticks;
  m_state.excess += force - m_state.answer.force;
}

void ForceBetweenSteps::serialize(Archive& archive) {
  const auto place = [&](const std::string& name, Place& p) {
    archive.array(name + "_position", p.tool.position);
    archive.quaternion(name + "_orientation", p.tool.orientation);
    archive.array(name + "_centre", p.centre);
    archive.array(name + "_outward", p.outward);
    archive.number(name + "_has_passed", p.has_passed);
    archive.number(name + "_springs", p.springs);
    archive.number(name + "_modulus", p.modulus);
    archive.number(name + "_cell", p.cell);
    archive.number(name + "_stiffness", p.stiffness);
    archive.array(name + "_sideways", p.sideways);
    archive.array(name + "_drift", p.drift);
    archive.number(name + "_give", p.give);
    archive.number(name + "_share", p.share);
  };
  place("between/told", m_state.told);
  place("between/place", m_state.place);
  archive.array("between/force", m_state.answer.force);
  archive.array("between/torque", m_state.answer.torque);
  archive.array("between/friction", m_state.friction);
  archive.number("between/ticks", m_state.ticks);
  archive.array("between/excess", m_state.excess);
  archive.array("between/owed", m_state.owed);
  archive.records("between/shares", m_state.shares, [](SurfaceForce& share, auto field) {
    for (int& vertex : share.vertex) field(vertex);
    for (double& weight : share.weight) field(weight);
    for (double& value : share.force) field(value);
  });
  if (archive.is_restoring()) commit();
}

}  // namespace argil::sim
