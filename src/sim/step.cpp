// One haptic tick: the paper's loop. Equation numbers are the paper's, listed in src/README.md.

#include <optional>

#include "sim/simulation.h"

namespace argil::sim {

StepStatus Simulation::tick(const device::DeviceSample& sample) {
  const RateParams& rates = m_params.rates;
  const bool physics_due = m_clock.due(rates.physics_period_ticks);

  // Device: the tool goes to where the hand is at the end of the tick.
  book_port_energy({sample.position, sample.orientation});
  m_state.tool = {sample.position, sample.orientation};
  m_state.mode = sample.mode;

  // Contact: eqs. 7 and 8 over the path since the last detection, reaction to the hand.
  ++m_state.force_age;
  if (rates.between_frames == BetweenFrames::re_evaluate)
    contact_step(1);
  else if (physics_due)
    contact_step(rates.physics_period_ticks);

  // Physics: what the water and the contact force do to the body.
  if (m_clock.due(rates.water_period_ticks)) ARGIL_TRY(water_step());
  if (physics_due) ARGIL_TRY(physics_step());

  // Hand: the last force, old or new, through the device's limits.
  m_gated = m_gate.apply(m_state.hand_force, m_state.hand_torque);
  m_clock.advance();
  return StepStatus::ok();
}

/// Detection over the last `ticks` ticks; both paths start where the last detection ended, so none has a gap.
void Simulation::contact_step(int ticks) {
  const StageScope scope(m_observer, Stage::contact);
  const bool has_moved = m_state.has_moved;
  if (has_moved) m_surface.find_positions(m_state.solid.x, m_surface_x);
  m_detector.find_contacts(m_state.contact_x, has_moved ? m_surface_x : m_state.contact_x,
                           m_state.contact_tool, m_state.tool, m_contacts,
                           has_moved ? std::optional<double>() : 0.0, m_clock.seconds(ticks));
  if (has_moved) m_state.contact_x.swap(m_surface_x);
  m_state.has_moved = false;
  m_state.contact_tool = m_state.tool;
  const double sign = m_state.mode == device::ToolMode::pull ? -1.0 : 1.0;  // pull: force reversed
  m_state.hand_force = sign * m_contacts.force_on_tool + m_contacts.resistance_on_tool;
  m_state.hand_torque = sign * m_contacts.torque_on_tool + m_contacts.resistance_torque_on_tool;
  m_state.force_age = 0;
  spread_contact_force(ticks);
}

/// Uptake from or to the tool, diffusion, then moduli and yield of the tets whose saturation moved (eq. 6).
StepStatus Simulation::water_step() {
  const StageScope scope(m_observer, Stage::water);
  const double h = m_clock.seconds(m_params.rates.water_period_ticks);
  const bool wet = m_state.mode == device::ToolMode::wet;
  if (wet || m_state.mode == device::ToolMode::dry) exchange_water(wet ? 1 : -1, h);
  m_water.diffuse(h);
  return refresh_materials(m_params.moisture.refresh_tolerance);
}

/// Eq. 2 by one implicit step: solve, scale the velocity (eq. 9), move, then plastic flow. A body at rest
/// that nothing acts on is left as it is.
StepStatus Simulation::physics_step() {
  if (rests()) return StepStatus::ok();
  const double h = m_clock.seconds(m_params.rates.physics_period_ticks);
  solid::SolidState& solid = m_state.solid;
  m_external_force = m_state.contact_force + m_load_force;
  const solid::StepLoads loads{m_external_force, m_contact_stiffness};
  ARGIL_TRY(m_solid.begin_step(solid, loads, h, m_clock.time_at_end(), m_clock.tick));
  for (bool solved = false; !solved;) {
    {
      const StageScope scope(m_observer, Stage::assemble);
      solved = m_solid.assemble(loads);  // A, b from F, R, ε
    }
    const StageScope scope(m_observer, Stage::solve);
    if (!solved) ARGIL_TRY(m_solid.solve(loads, m_clock.tick, solved));  // A δv = b
  }
  {
    const StageScope scope(m_observer, Stage::solve);
    apply_contact_yield();
    m_solid.finish_step(solid);
    apply_clay_kernel(h);  // v ← G_d^{h/h_ref} v
    m_x_before = solid.x;
    m_solid.move(solid);
    m_state.has_moved = true;
    m_state.contact_work += m_state.contact_force.cwiseProduct(solid.x - m_x_before).sum();
    m_state.contact_force.setZero();
    m_state.is_touched = false;
  }
  {
    const StageScope scope(m_observer, Stage::kinematics);
    ARGIL_TRY(m_solid.update_kinematics(solid.x, m_clock.tick));  // F → R → ε
  }
  const StageScope scope(m_observer, Stage::plasticity);
  apply_plastic_flow(h);  // trial ε_p of every tet, committed at once
  return StepStatus::ok();
}

}  // namespace argil::sim
