// One haptic tick: the paper's loop. Equation numbers are the paper's, listed in src/README.md.

#include "base/check.h"
#include "sim/simulation.h"

namespace argil::sim {

StepStatus Simulation::tick(const device::DeviceSample& sample) {
  ARGIL_TRY(m_hand.status());
  const bool physics_due = clock().due(m_params.rates.physics_period_ticks);

  // Device: the tool goes to where the hand is at the end of the tick.
  m_hand.move(sample);

  // Contact: eqs. 7 and 8 over the path since the last detection, reaction to the hand.
  const BodyAtFrame body = m_body_side.at_frame(clock().tick);
  ARGIL_TRY(m_hand.touch(physics_due, &body));

  // Physics: what the water and the contact force do to the body.
  if (physics_due) {
    m_hand.give(m_load);
    const StepStatus status = m_body_side.step(m_load, m_answer);
    m_hand.see(m_answer);
    ARGIL_TRY(status);
    if (m_answer.has_moved) ARGIL_TRY(m_hand.begin_frame(body, m_body_side.x_before()));
  }

  // Hand: the last force, old or new, as the device renders it.
  m_hand.render(device::HandFeed::fresh);
  return StepStatus::ok();
}

StepStatus Simulation::tick(const device::DeviceSample& sample, const TickPlan& plan) {
  ARGIL_ASSERT(m_params.rates.between_frames != BetweenFrames::compliant);
  ARGIL_TRY(m_hand.status());
  if (plan.sees_step) {
    if (!m_step_status.is_ok()) return m_step_status;
    m_hand.see(m_answer);
  }
  m_hand.move(sample);
  ARGIL_TRY(m_hand.touch(plan.begins_step, nullptr));
  if (plan.begins_step) {
    m_hand.give(m_load);
    m_step_status = m_body_side.step(m_load, m_answer);
  }
  m_hand.render(plan.feed);
  return StepStatus::ok();
}

StepStatus HandSide::touch(bool begins_step, const BodyAtFrame* body) {
  const RateParams& rates = m_params.rates;
  const bool water_due = begins_step && (m_steps_begun + 1) % steps_per_water() == 0;
  m_contacts.with_touched = water_due && is_wetting();
  ++m_state.force_age;
  if (is_yielding()) return yielding_contact_step(*body);
  if (rates.between_frames != BetweenFrames::hold)
    contact_step(1, body);
  else if (begins_step)
    contact_step(m_ticks_since_step, body);
  return StepStatus::ok();
}

/// Detection over the last `ticks` ticks against the surface of the last physics step.
void HandSide::contact_step(int ticks, const BodyAtFrame* body) {
  const StageScope scope(m_observer, Stage::contact);
  if (m_compliance.num_known() > 0) {
    m_springs.clear();
    m_compliance.release();
    move_surface(body->state.x);
  }
  find_contacts(ticks);
  const double sign = m_state.mode == device::ToolMode::pull ? -1.0 : 1.0;  // pull: force reversed
  m_state.hand_force = sign * m_contacts.force_on_tool + m_contacts.resistance_on_tool;
  m_state.hand_torque = sign * m_contacts.torque_on_tool + m_contacts.resistance_torque_on_tool;
  spread_contact_force();
}

/// Detection over the last tick against a surface that yields: it first follows the tool as far as the
/// springs of the last contacts let it, then comes to balance with those that are found. The hand feels the
/// force of the place where it is; pairs that came and went within the tick add their mean.
StepStatus HandSide::yielding_contact_step(const BodyAtFrame& body) {
  const StageScope scope(m_observer, Stage::contact);
  follow_with_springs();
  const bool has_yielded = m_compliance.num_known() > 0;
  ARGIL_TRY(m_compliance.press(body, m_springs));
  m_compliance.displace(body.state.x, m_yielded_x);
  if (m_state.has_moved || has_yielded) move_surface(m_yielded_x);
  find_contacts(1);
  make_springs();
  ARGIL_TRY(m_compliance.press(body, m_springs));

  m_state.hand_force.setZero();
  m_state.hand_torque.setZero();
  // `spring`: the contact as it acts where the step begins, before the surface yields.
  const auto act = [&](contact::Contact c, const Vec3& on_hand, const ContactSpring& spring) {
    m_state.hand_force -= on_hand + c.resistance;
    m_state.hand_torque -= (c.point - m_state.tool.position).cross(on_hand + c.resistance);
    const Vec3 force = spring.force * spring.normal + c.resistance;
    act_on_body(c, force);
    c.stiffness = spring.stiffness;
    const std::size_t entry = m_load.stiffness.size();
    add_contact_stiffness(c, m_share * force, true);
    const bool is_spring = m_load.stiffness.size() > entry;
    m_compliance.hold(spring, m_share, is_spring ? m_load.stiffness[entry].group : -1);
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
  m_load.last_detection = m_load.stiffness.size();  // the hand has felt the yield already
  return StepStatus::ok();
}

StepStatus BodySide::step(ContactLoad& load, BodyAnswer& answer) {
  const RateParams& rates = m_params.rates;
  begin_step(load, answer);
  StepStatus status = StepStatus::ok();
  if (m_state.steps * rates.physics_period_ticks % rates.water_period_ticks == 0) status = water_step(load);
  if (status.is_ok() && !rests(load)) status = physics_step(load, answer);
  load.clear();
  return status;
}

/// Uptake from or to the tool, diffusion, then moduli and yield of the tets whose saturation moved (eq. 6).
StepStatus BodySide::water_step(const ContactLoad& load) {
  const StageScope scope(m_observer, Stage::water);
  const double h = m_params.rates.haptic_period * m_params.rates.water_period_ticks;
  const bool wet = load.mode == device::ToolMode::wet;
  if (wet || load.mode == device::ToolMode::dry)
    m_water.exchange_tets(load.touched_tet, load.touched_area, wet ? 1 : -1, h);
  m_water.diffuse(h);
  return refresh_materials(m_params.moisture.refresh_tolerance);
}

/// Eq. 2 by one implicit step: solve, scale the velocity (eq. 9), move, then plastic flow. A body at rest
/// that nothing acts on is left as it is.
StepStatus BodySide::physics_step(ContactLoad& load, BodyAnswer& answer) {
  const double h = step_seconds();
  solid::SolidState& solid = m_state.solid;
  set_external_force(load);
  solid::StepLoads loads{m_external_force, load.stiffness};
  loads.changed = &m_changed_nodes;
  loads.slack = m_fidelity.solve_slack();
  loads.limit = m_fidelity.solve_limit();
  loads.region_slack = m_fidelity.region_slack();
  if (load.is_pressed)
    loads.mobility = [this, &load](Eigen::Index node) { return clay_factor(node, load, step_seconds()); };
  const double energy_given = m_state.energy_given;
  const auto fail = [&](const StepStatus& status) {
    take_back(energy_given);  // the last good state stays
    answer.felt = load.hand.felt;
    return status;
  };
  {
    const StageScope scope(m_observer, Stage::assemble);
    const StepStatus status = m_solid.begin_step(solid, loads, h, time_at_end(), tick());
    if (!status.is_ok()) return fail(status);
  }
  for (bool solved = false; !solved;) {
    {
      const StageScope scope(m_observer, Stage::assemble);
      solved = m_solid.assemble(loads);  // A, b from F, R, ε
    }
    const bool is_first = m_solid.counters().newton_iterations == 0;
    if (!m_fidelity.is_full() && is_first && falls_asleep(load, loads)) return StepStatus::ok();
    const StageScope scope(m_observer, Stage::solve);
    const StepStatus status = solved ? StepStatus::ok() : m_solid.solve(loads, tick(), solved);  // A δv = b
    if (!status.is_ok()) return fail(status);
  }
  {
    const StageScope scope(m_observer, Stage::solve);
    apply_contact_yield(load, answer.felt);
    m_solid.finish_step(solid);
    apply_clay_kernel(load, h);  // v ← G_d^{h/h_ref} v
    m_solid.move(solid);
  }
  {
    const StageScope scope(m_observer, Stage::kinematics);
    StepStatus status = check_energy(load);
    if (status.is_ok()) status = m_solid.update_kinematics(solid.x, tick());  // F → R → ε
    if (!status.is_ok()) return fail(status);
    m_solid.keep_start(solid);
    for (const int n : load.force.nodes)
      m_state.contact_work += load.force.at.col(n).dot(solid.x.col(n) - m_solid.x_start().col(n));
  }
  const StageScope scope(m_observer, Stage::plasticity);
  apply_plastic_flow(h);  // trial ε_p of every tet, committed at once
  m_solid.settle_region(solid, m_is_flowing);
  watch_strain();
  m_fidelity.set_made(m_solid.counters().has_solved, m_solid.counters().imbalance, m_solid.held_back());
  answer.is_whole = !m_surface.find_moved(m_solid.moving_nodes(), solid.x, answer.moved, answer.surface_x);
  if (answer.is_whole) m_surface.find_positions(solid.x, answer.surface_x);
  answer.has_moved = true;
  return StepStatus::ok();
}

}  // namespace argil::sim
