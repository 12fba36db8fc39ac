// Between the contacts, the body and the hand: who gets which force.

#include <array>
#include <cmath>
#include <optional>

#include "sim/simulation.h"

namespace argil::sim {

using device::ToolMode;

/// The tool goes to where the hand is at the end of the tick. The device holds its last force on the way, so
/// that the work done on the hand is force times path, exactly; a turn is taken about one axis.
void Simulation::move_hand(const device::DeviceSample& sample) {
  const Eigen::AngleAxisd turn(sample.orientation * m_state.tool.orientation.conjugate());  // the shorter way
  m_state.motion = {sample.position - m_state.tool.position, turn.angle() * turn.axis()};
  m_state.port_energy += device::compute_work({m_gated.force, m_gated.torque}, m_state.motion);
  m_state.passivity_energy += device::compute_work(m_state.withheld, m_state.motion);
  m_state.tool = {sample.position, sample.orientation};
  m_state.mode = sample.mode;
}

/// Detection over `ticks` ticks while the body goes to where its nodes are at x; both paths start where the
/// last one ended, so none has a gap.
void Simulation::find_contacts(const Points& x, int ticks) {
  const bool has_moved = m_state.has_moved;
  const bool is_wetting = m_state.mode == ToolMode::wet || m_state.mode == ToolMode::dry;
  m_contacts.with_touched = is_wetting && m_clock.due(m_params.rates.water_period_ticks);
  if (has_moved) m_surface.find_positions(x, m_surface_x);
  m_detector.find_contacts(m_state.contact_x, has_moved ? m_surface_x : m_state.contact_x,
                           m_state.contact_tool, m_state.tool, m_contacts,
                           has_moved ? std::optional<double>() : 0.0, m_clock.seconds(ticks));
  m_state.num_contacts = static_cast<int>(m_contacts.contacts.size());
  if (has_moved) m_state.contact_x.swap(m_surface_x);
  m_state.has_moved = false;
  m_state.contact_tool = m_state.tool;
  m_state.force_age = 0;
  m_state.is_pressed = false;
  m_state.contact_centre.setZero();
  m_pressed_weight = 0.0;
}

/// Adds a share of a contact's force on the body to the mean over the physics step.
void Simulation::act_on_body(const contact::Contact& c, const Vec3& force, double share) {
  m_state.is_touched = true;
  m_surface.add_force(c, share * force, m_state.contact_force);
  // The centre of pressure so far.
  const double weight = force.norm();
  m_pressed_weight += weight;
  m_state.is_pressed = m_pressed_weight > 0.0;
  if (weight > 0.0) m_state.contact_centre += weight / m_pressed_weight * (c.point - m_state.contact_centre);
}

/// Eqs. 7 and 8 on the body, reversed in pull. Wet and dry tools feel the body but do not deform it.
void Simulation::spread_contact_force(int ticks) {
  m_last_detection = m_contact_stiffness.size();
  if (m_state.mode == ToolMode::wet || m_state.mode == ToolMode::dry) return;
  const bool pushes = m_state.mode == ToolMode::push;
  const double share = static_cast<double>(ticks) / m_params.rates.physics_period_ticks;
  for (const contact::Contact& c : m_contacts.contacts) {
    const Vec3 force = (pushes ? c.force : Vec3(-c.force)) + c.resistance;
    act_on_body(c, force, share);
    add_contact_stiffness(c, share * force, pushes, share);
  }
}

/// How a contact's force changes as the body moves on: falls by its stiffness, by damping with the speed, and
/// along the surface while it sticks, or across its way where it slides. One that pushes lets go before it
/// would draw. A pulling contact has negative stiffness; left out, so that the system stays positive
/// definite.
void Simulation::add_contact_stiffness(const contact::Contact& c, const Vec3& force, bool pushes,
                                       double share) {
  // The damping force counted with the body's last speed; the solve finds the next, from a force without it.
  const double per_speed = c.damping / m_clock.seconds(m_params.rates.physics_period_ticks);
  const double at_rest = c.damping * c.body_speed;
  const std::size_t first = m_contact_stiffness.size();
  add_contact_stiffness(c, c.normal, share * ((pushes ? c.stiffness : 0.0) + per_speed), share * at_rest);
  const std::size_t pieces = m_contact_stiffness.size() - first;
  const std::size_t leader = pushes && pieces > 0 ? find_group(c, first, pieces) : 0;
  for (std::size_t i = 0; pushes && i < pieces; ++i) {
    solid::PointStiffness& piece = m_contact_stiffness[first + i];
    piece.force = (pieces == 1 ? 1.0 : c.weight[i]) * force + m_yields[first + i].force_at_rest * c.normal;
    piece.group = static_cast<int>(leader + i);
    piece.counts = true;
  }
  if (c.sticking == 0.0) return;
  const bool slides = c.sticking < 0.0;
  const Vec3 dragged = c.resistance - c.normal.dot(c.resistance) * c.normal;
  const Vec3 along = slides ? dragged.normalized() : c.normal.unitOrthogonal();
  const std::array<Vec3, 2> directions = {c.normal.cross(along), along};
  for (std::size_t d = 0; d < (slides ? 1 : 2); ++d) {
    const std::size_t begin = m_contact_stiffness.size();
    add_contact_stiffness(c, directions[d], share * std::abs(c.sticking), 0.0);
    for (std::size_t i = 0; pushes && i < pieces; ++i)
      m_contact_stiffness[begin + i].group = static_cast<int>(leader + i);
  }
}

/// What presses on the same vertices in several ticks of a step is one contact to the body, which gets the
/// mean. Number of the first piece of the first of them, or `first` when there was none yet.
std::size_t Simulation::find_group(const contact::Contact& c, std::size_t first, std::size_t pieces) {
  for (const ContactGroup& group : m_contact_groups)
    if (group.vertex == c.vertex && group.pieces == pieces) return group.first;
  m_contact_groups.push_back({c.vertex, first, pieces});
  return first;
}

void Simulation::add_contact_stiffness(const contact::Contact& c, const Vec3& direction, double stiffness,
                                       double force_at_rest) {
  if (!(stiffness > 0.0)) return;
  m_surface.add_stiffness(c, direction, stiffness, m_solid.elements(), m_contact_stiffness);
  const bool is_implicit =
      m_params.solid.implicit_contact && m_params.solid.integrator != solid::Integrator::symplectic_euler;
  if (!is_implicit) force_at_rest = 0.0;
  if (force_at_rest != 0.0) m_surface.add_force(c, force_at_rest * direction, m_state.contact_force);
  // One entry stands for the contact as a whole, more of them for one of its vertices each.
  const std::size_t added = m_contact_stiffness.size() - m_yields.size();
  for (std::size_t i = 0; i < added; ++i)
    m_yields.push_back(added == 1 ? Yield{c.point, force_at_rest}
                                  : Yield{m_state.contact_x.col(c.vertex[i]), c.weight[i] * force_at_rest});
}

/// What a step has found the body to yield under the tool lets the forces of its contacts fall: those on the
/// body, and of the last detection those that the hand feels. With one detection a step, both are equal and
/// opposite.
void Simulation::apply_contact_yield() {
  m_solid.apply_contact_stiffness(m_contact_stiffness, m_state.contact_force);
  const RateParams& rates = m_params.rates;
  const double per_share = rates.between_frames == BetweenFrames::hold ? 1.0 : rates.physics_period_ticks;
  for (std::size_t i = m_last_detection; i < m_contact_stiffness.size(); ++i) {
    const Vec3 at_rest = m_yields[i].force_at_rest * m_contact_stiffness[i].normal;
    const Vec3 change = per_share * (at_rest + m_solid.compute_contact_change(m_contact_stiffness, i));
    m_state.hand_force -= change;
    m_state.hand_torque -= (m_yields[i].point - m_state.tool.position).cross(change);
  }
  m_contact_stiffness.clear();
  m_contact_groups.clear();
  m_yields.clear();
  m_last_detection = 0;
}

/// Does the surface yield between physics steps? Tools that do not deform the body meet it as it is, and so
/// does a pulling one, whose negative stiffness has no balance with the body where it is the stiffer.
bool Simulation::is_yielding() const {
  return m_params.rates.between_frames == BetweenFrames::compliant && m_state.mode == ToolMode::push;
}

BodyAtFrame Simulation::body_at_frame() {
  return {m_solid, m_surface, m_state.solid, m_clock.seconds(m_params.rates.physics_period_ticks),
          m_clock.tick};
}

/// The springs of the last detection go with the tool.
void Simulation::follow_with_springs() {
  const contact::Pose& from = m_state.contact_tool;
  for (ContactSpring& spring : m_springs) {
    const Vec3 in_tool = from.orientation.conjugate() * (spring.point - from.position);
    const Vec3 point = m_state.tool.position + m_state.tool.orientation * in_tool;
    spring.force += spring.stiffness * spring.normal.dot(point - spring.point);
  }
}

/// Springs of the pairs that are in penetration at the end of the tick.
void Simulation::make_springs() {
  m_springs.clear();
  m_spring_contact.clear();
  for (std::size_t i = 0; i < m_contacts.contacts.size(); ++i) {
    const contact::Contact& c = m_contacts.contacts[i];
    if (!(c.end_stiffness > 0.0)) continue;
    m_springs.push_back({c.vertex, c.weight, c.normal, c.end_stiffness, c.end_force, c.point});
    m_spring_contact.push_back(i);
  }
}

/// The last force, old or new, less what would generate energy, through the device's limits.
void Simulation::render_force() {
  const device::Wrench felt{m_state.hand_force, m_state.hand_torque};
  device::Wrench sent = felt;
  if (m_params.passivity == device::Passivity::time_domain)
    sent = device::damp_generated_energy(felt, m_state.motion, -m_state.port_energy);
  m_state.withheld = {felt.force - sent.force, felt.torque - sent.torque};
  m_gated = m_gate.apply(sent.force, sent.torque);
}

}  // namespace argil::sim
