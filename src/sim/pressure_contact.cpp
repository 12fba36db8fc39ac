// Contact as pressure over the touched patch: push, pull, and tools under which the body keeps its shape.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "material/plasticity.h"
#include "sim/hand_side.h"

namespace argil::sim {

using device::ToolMode;

namespace {

constexpr double kSurelyCovered = 0.75;  // of a patch's radius, which counts what is just beside it as well

/// Of the least disc [m] that bears such a force [N] on clay that flows: a flat one of a rough punch bears
/// 6.05 c_u, and nothing more. 0: the clay does not flow, or not at once.
double find_least_radius(const Params& params, double force) {
  constexpr double kBearing = 6.05;
  if (!params.plasticity.enabled || params.plasticity.form != material::FlowForm::j2) return 0.0;
  const double shear_modulus = params.elastic.youngs_modulus / (2.0 * (1.0 + params.elastic.poissons_ratio));
  const double strength =
      std::numbers::sqrt2 * shear_modulus * material::compute_yield_strain(params.plasticity, params.elastic);
  return strength > 0.0 ? std::sqrt(force / (kBearing * strength * std::numbers::pi)) : 0.0;
}

}  // namespace

/// How the body answers is decided where the tool comes to touch it, and stays so until it has left: no mode
/// that is chosen in between kicks the hand, and a shape that was pressed in is held. What water does follows
/// the mode at once.
void HandSide::choose_yielding() {
  if (!m_pressure || m_state.num_contacts > 0) return;
  m_state.yielding = is_wetting() ? contact::Yielding::no : contact::Yielding::yes;
}

bool HandSide::keeps_shape() const {
  return m_pressure ? m_state.yielding == contact::Yielding::no : is_wetting();
}

/// A pulling tool presses in like a pushing one until the hand turns back; then it holds what it touches. Of
/// a body that keeps its shape nothing would come along.
void HandSide::update_grip() {
  if (m_state.mode != ToolMode::pull || keeps_shape()) {
    m_grip.forget();
    return m_grip.release();
  }
  m_grip.test(m_state.last_answer, m_state.contact_tool, m_state.tool);
  if (m_grip.has_let_go() && m_state.num_contacts == 0) m_grip.release();
  const bool turns_back =
      (m_state.tool.position - m_state.contact_tool.position).dot(m_state.last_answer) > 0.0;
  if (m_grip.holds() || m_grip.has_let_go() || m_state.num_contacts == 0 || !turns_back) return;
  m_pressure->find_contacts(m_touched.x_t1(), m_state.contact_tool, m_state.contact_tool, m_state.yielding,
                            m_contacts);
  // What is left of the depth after a step is not what has pressed in it: as the patch changes, its points
  // are weighed anew, the more the stiffer κ.
  m_grip.find_pressed(m_touched.x_t0(), m_touched.x_t1(), m_contacts);
  // A step that does not solve for its contacts answers with a mean over the tool's way.
  const Vec3 answer = m_params.solid.solves_contact() ? m_state.last_answer : m_contacts.force_on_tool;
  // Facets of a thin or coarse part touch with a corner or a ridge alone.
  contact::Patch patch = m_pressure->find_patch();
  patch.radius = std::max(kSurelyCovered * patch.radius, find_least_radius(m_params, answer.norm()));
  m_grip.hold(m_contacts, patch, m_touched.x_t1(), answer, m_state.contact_tool);
}

void HandSide::meet_surface() {
  if (!m_has_met_surface) m_pressure->advance(m_touched.x_t0(), m_touched.x_t1(), m_touched.find_motion());
  m_has_met_surface = true;
}

/// Of the tool in a detection that has just been made, over the radius of what it presses on; 0 where it
/// grips.
double HandSide::find_way_over_patch() const {
  const double radius = m_grip.holds() ? 0.0 : m_pressure->find_patch().radius;
  return radius > 0.0 ? (m_state.tool.position - m_state.contact_tool.position).norm() / radius : 0.0;
}

/// Of a patch that gives way. Faces of ten-node tets bend with the tool, and have no sag.
PatchResolution HandSide::find_resolution() {
  if (!m_params.estimates_error || !m_pressure || keeps_shape() || m_grip.holds()) return {};
  const contact::Patch patch = m_pressure->find_patch();
  PatchResolution found;
  if (patch.cell > 0.0) found.cells = patch.radius / patch.cell;
  if (m_params.solid.element == solid::ElementKind::p2) return found;
  double force = 0.0;
  for (const contact::Contact& c : m_contacts.contacts) force += c.end_force;
  found.sag = m_pressure->find_sag(m_touched.x_t0(), force);
  return found;
}

/// The body is told of one detection a step; until it answers, the hand feels the last answer.
void HandSide::find_pressure_force(bool begins_step) {
  if (!begins_step) return;
  m_felt = {m_state.hand_force, m_state.hand_torque};
  m_told_tool = m_state.contact_tool;
  find_penalty_force(m_state.ticks_since_step);
}

ForceBetweenSteps::Unpressed HandSide::find_unpressed(const contact::Pose& tool) {
  m_pressure->find_unpressed(m_touched.x_t1(), tool, m_unpressed);
  ForceBetweenSteps::Unpressed unpressed{m_unpressed.force_on_tool, 0.0};
  for (const contact::Contact& c : m_unpressed.contacts) unpressed.stiffness += c.end_stiffness;
  return unpressed;
}

/// What the clay would add by now to its last answer.
void HandSide::feel_between_steps() {
  const StageScope scope(m_observer, Stage::contact);
  if (keeps_shape()) return m_between->feel(Vec3::Zero());
  meet_surface();
  ForceBetweenSteps::Limits limits{m_grip.holds(), m_params.contact.friction, {}};
  const bool may_be_unpressed = !limits.holds && m_between->may_be_unpressed(m_state.tool);
  if (m_between->wants_compared() && (may_be_unpressed || !m_between->knows_stiffness()))
    m_between->compare(find_unpressed(m_between->tool()));
  if (may_be_unpressed) limits.unpressed = find_unpressed(m_state.tool);
  const device::Wrench felt = m_between->forecast(m_state.tool, limits);
  m_state.hand_force = felt.force;
  m_state.hand_torque = felt.torque;
  m_state.force_age = 0;
  m_between->feel(felt.force);
}

void HandSide::find_pressure() {
  meet_surface();
  update_grip();
  if (m_grip.holds()) {
    const contact::Pose& from = m_params.solid.solves_contact() ? m_state.tool : m_state.contact_tool;
    return m_grip.find_contacts(m_touched.x_t1(), from, m_state.tool, m_contacts);
  }
  m_pressure->find_contacts(m_touched.x_t1(), m_state.contact_tool, m_state.tool, m_state.yielding,
                            m_contacts);
  const bool may_grip = m_state.mode == ToolMode::pull && !keeps_shape() && !m_grip.has_let_go();
  if (may_grip && m_params.solid.solves_contact()) m_grip.remember(m_contacts);
  if (m_friction && !keeps_shape())
    m_friction->stretch(m_touched.x_t0(), m_touched.x_t1(), m_state.contact_tool, m_state.tool, m_contacts);
}

/// Pressures on the body and how they change as it moves on.
void HandSide::gather_pressure() {
  for (const contact::Contact& c : m_contacts.contacts) {
    m_collector.add_force(c, c.force + c.resistance);
    if (m_grip.holds()) {
      m_collector.add_bond(c, m_touched.x_t0());
      continue;
    }
    m_collector.add_pressure(c, false, m_touched.x_t0());
  }
  for (const contact::Contact& c : m_contacts.near) m_collector.add_pressure(c, true, m_touched.x_t0());
}

}  // namespace argil::sim
