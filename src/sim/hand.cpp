// Between the contacts, the body and the hand: who gets which force.

#include "sim/simulation.h"

namespace argil::sim {

/// ∫ F·v + T·ω dt over the tick that brings the hand to `next`. The device holds its last force meanwhile, so
/// that this is force times path, exactly; the turn is taken about one axis.
void Simulation::book_port_energy(const contact::Pose& next) {
  const Eigen::AngleAxisd turn(next.orientation * m_state.tool.orientation.conjugate());  // the shorter way
  m_state.port_energy += m_gated.force.dot(next.position - m_state.tool.position) +
                         m_gated.torque.dot(turn.angle() * turn.axis());
}

/// Adds this detection's contact forces, and their stiffness for the solve, to the mean over the physics
/// step. Wet and dry tools feel the body but do not deform it.
void Simulation::spread_contact_force(int ticks) {
  const bool acts = m_state.mode == device::ToolMode::push || m_state.mode == device::ToolMode::pull;
  const double sign = m_state.mode == device::ToolMode::pull ? -1.0 : 1.0;
  const double share = static_cast<double>(ticks) / m_params.rates.physics_period_ticks;
  m_last_detection = m_contact_stiffness.size();
  Vec3 weighted_centre = Vec3::Zero();
  double weight = 0.0;
  for (const contact::Contact& c : m_contacts.contacts) {
    if (!acts) break;
    m_state.is_touched = true;
    m_surface.add_force(c, share * (sign * c.force + c.resistance), m_state.contact_force);
    add_contact_stiffness(c, sign > 0.0, share);
    weighted_centre += c.force.norm() * c.point;
    weight += c.force.norm();
  }
  m_state.is_pressed = weight > 0.0;
  if (m_state.is_pressed) m_state.contact_centre = weighted_centre / weight;
}

/// How a contact's force changes as the body moves on: falls by its stiffness, by damping with the speed, and
/// along the surface while it sticks. A pulling contact has negative stiffness; left out, so that the system
/// stays positive definite.
void Simulation::add_contact_stiffness(const contact::Contact& c, bool pushes, double share) {
  // The damping force counted with the body's last speed; the solve finds the next, from a force without it.
  const double per_speed = c.damping / m_clock.seconds(m_params.rates.physics_period_ticks);
  const double at_rest = c.damping * c.body_speed;
  add_contact_stiffness(c, c.normal, share * ((pushes ? c.stiffness : 0.0) + per_speed), share * at_rest);
  if (c.sticking == 0.0) return;
  const Vec3 along = c.normal.unitOrthogonal();
  for (const Vec3& direction : {along, Vec3(c.normal.cross(along))})
    add_contact_stiffness(c, direction, share * c.sticking, 0.0);
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
    const solid::PointStiffness& stiffness = m_contact_stiffness[i];
    const double fall = m_yields[i].force_at_rest + m_solid.compute_contact_change(stiffness);
    const Vec3 change = per_share * fall * stiffness.normal;
    m_state.hand_force -= change;
    m_state.hand_torque -= (m_yields[i].point - m_state.tool.position).cross(change);
  }
  m_contact_stiffness.clear();
  m_yields.clear();
  m_last_detection = 0;
}

}  // namespace argil::sim
