// One haptic tick: the paper's loop. Equation numbers are the paper's, listed in src/README.md.

#include "sim/simulation.h"

namespace argil::sim {

StepStatus Simulation::tick(const device::DeviceSample& sample) {
  const RateParams& rates = m_params.rates;
  const bool physics_due = m_clock.due(rates.physics_period_ticks);

  // Device: the tool goes to where the hand is at the end of the tick.
  move_hand(sample);

  // Contact: eqs. 7 and 8 over the path since the last detection, reaction to the hand.
  ++m_state.force_age;
  if (is_yielding()) {
    ARGIL_TRY(yielding_contact_step());
  } else if (rates.between_frames != BetweenFrames::hold) {
    contact_step(1);
  } else if (physics_due) {
    contact_step(rates.physics_period_ticks);
  }

  // Physics: what the water and the contact force do to the body.
  if (m_clock.due(rates.water_period_ticks)) ARGIL_TRY(water_step());
  if (physics_due) ARGIL_TRY(physics_step());

  // Hand: the last force, old or new, as the device renders it.
  render_force();
  m_clock.advance();
  return StepStatus::ok();
}

/// Detection over the last `ticks` ticks against the surface of the last physics step.
void Simulation::contact_step(int ticks) {
  const StageScope scope(m_observer, Stage::contact);
  if (m_compliance.num_known() > 0) {
    m_springs.clear();
    m_compliance.release();
    m_state.has_moved = true;
  }
  find_contacts(m_state.solid.x, ticks);
  const double sign = m_state.mode == device::ToolMode::pull ? -1.0 : 1.0;  // pull: force reversed
  m_state.hand_force = sign * m_contacts.force_on_tool + m_contacts.resistance_on_tool;
  m_state.hand_torque = sign * m_contacts.torque_on_tool + m_contacts.resistance_torque_on_tool;
  spread_contact_force(ticks);
}

/// Detection over the last tick against a surface that yields: it first follows the tool as far as the
/// springs of the last contacts let it, then comes to balance with those that are found. The hand feels the
/// force of the place where it is; pairs that came and went within the tick add their mean.
StepStatus Simulation::yielding_contact_step() {
  const StageScope scope(m_observer, Stage::contact);
  const BodyAtFrame body = body_at_frame();
  follow_with_springs();
  if (m_compliance.num_known() > 0) m_state.has_moved = true;
  ARGIL_TRY(m_compliance.press(body, m_springs));
  m_compliance.displace(m_state.solid.x, m_yielded_x);
  find_contacts(m_yielded_x, 1);
  make_springs();
  ARGIL_TRY(m_compliance.press(body, m_springs));

  m_state.hand_force.setZero();
  m_state.hand_torque.setZero();
  const double share = 1.0 / m_params.rates.physics_period_ticks;
  // `spring`: the contact as it acts where the step begins, before the surface yields.
  const auto act = [&](contact::Contact c, const Vec3& on_hand, const ContactSpring& spring) {
    m_state.hand_force -= on_hand + c.resistance;
    m_state.hand_torque -= (c.point - m_state.tool.position).cross(on_hand + c.resistance);
    const Vec3 force = spring.force * spring.normal + c.resistance;
    act_on_body(c, force, share);
    c.stiffness = spring.stiffness;
    const std::size_t entry = m_contact_stiffness.size();
    add_contact_stiffness(c, share * force, true, share);
    const bool is_spring = m_contact_stiffness.size() > entry;
    m_compliance.hold(spring, share, is_spring ? m_contact_stiffness[entry].group : -1);
  };
  for (std::size_t i = 0; i < m_springs.size(); ++i) {
    ContactSpring spring = m_springs[i];
    if (!(spring.force > 0.0)) continue;
    const Vec3 on_hand = spring.force * spring.normal;
    spring.force += spring.stiffness * m_compliance.compute_yield(m_surface, spring);
    act(m_contacts.contacts[m_spring_contact[i]], on_hand, spring);
  }
  for (const contact::Contact& c : m_contacts.contacts)
    if (c.passes) act(c, c.force, {c.vertex, c.weight, c.normal, 0.0, c.force.norm(), c.point});
  m_last_detection = m_contact_stiffness.size();  // the hand has felt the yield already
  return StepStatus::ok();
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
  solid::StepLoads loads{m_external_force, m_contact_stiffness};
  if (m_state.is_pressed) loads.mobility = [this, h](Eigen::Index node) { return clay_factor(node, h); };
  m_v_before = solid.v;
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
  }
  {
    const StageScope scope(m_observer, Stage::kinematics);
    StepStatus status = check_energy();
    if (status.is_ok()) status = m_solid.update_kinematics(solid.x, m_clock.tick);  // F → R → ε
    if (!status.is_ok()) {
      solid.x = m_x_before;  // the last good state stays
      solid.v = m_v_before;
      return status;
    }
  }
  const StageScope scope(m_observer, Stage::plasticity);
  apply_plastic_flow(h);  // trial ε_p of every tet, committed at once
  m_solid.settle_region(solid, m_is_flowing);
  if (m_params.rates.between_frames == BetweenFrames::compliant)
    ARGIL_TRY(m_compliance.begin_frame(body_at_frame(), m_x_before));
  m_state.contact_force.setZero();
  m_state.is_touched = false;
  return StepStatus::ok();
}

}  // namespace argil::sim
