// One haptic tick: the paper's loop. Equation numbers are the paper's, listed in src/README.md.

#include "sim/body_side.h"
#include "sim/hand_side.h"
#include "sim/tick.h"
#include "solid/move.h"

namespace argil::sim {

StepStatus make_tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample,
                     const TickPlan& plan) {
  ARGIL_TRY(hand.status());
  if (plan.receives_step) ARGIL_TRY(steps.receive_step(hand));
  hand.advance(sample);                                  // the tool's path on [t, t + δ]
  ARGIL_TRY(hand.find_contact_force(plan.begins_step));  // eqs. 7 and 8; reaction to the hand; may be held
  if (plan.begins_step) steps.start_step(hand);          // the body under what the hand has gathered
  if (plan.waits_for_result) ARGIL_TRY(steps.receive_step(hand));
  hand.render(plan.feed);  // the last force, old or new
  return StepStatus::ok();
}

StepStatus tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample, const TickPlan& plan,
                ContactLoad* load) {
  StepStatus status = make_tick(hand, steps, sample, plan);
  if (status.is_ok())
    hand.commit();
  else
    hand.roll_back(load);
  return status;
}

/// Detection over the last `ticks` ticks against the surface of the last physics step; in `hold` only in the
/// ticks that begin a step.
void HandSide::find_penalty_force(int ticks) {
  release_springs();
  find_contacts(ticks);
  const double sign = reverses() ? -1.0 : 1.0;  // eqs. 7 and 8, pull: force reversed
  m_state.hand_force = sign * m_contacts.force_on_tool + m_contacts.resistance_on_tool;
  m_state.hand_torque = sign * m_contacts.torque_on_tool + m_contacts.resistance_torque_on_tool;
  gather_contact_forces();
}

/// Uptake from or to the tool, diffusion, then moduli and yield of the tets whose saturation moved (eq. 6).
StepStatus BodySide::move_water(const ContactLoad& load, StepResult& result) {
  transfer_and_diffuse(load, m_params.rates.haptic_period * m_params.rates.water_period_ticks);
  return refresh_materials(result);
}

/// Eq. 2: the velocity v' at the end of the step, or the body stops where it is and is at rest from now on.
StepStatus BodySide::find_velocity(const ContactLoad& load) {
  ARGIL_TRY(predict(load));  // x̂, v̂, τ
  for (bool is_solved = false; !is_solved;) {
    is_solved = assemble_or_stop();               // A, b from F, R, ε
    if (!is_solved) ARGIL_TRY(solve(is_solved));  // A δv = b
  }
  return StepStatus::ok();
}

StepStatus BodySide::move_solid(const ContactLoad& load, StepResult& result) {
  apply_deflection(load, result);                                 // what contacts lose as the body moves on
  solid::take_velocity(m_solid, m_region.part(), m_state.solid);  // v ← v'
  scale_velocity(load.patch);                                     // v ← G_d^{h/h_ref} v (eq. 9)
  m_error.keep_solution(load, m_force.contacts(), m_state.solid.v);
  solid::move(m_solid, m_region.part(), m_state.solid);  // x ← x̂ + τ v
  ARGIL_TRY(check_energy());
  ARGIL_TRY(update_kinematics());  // F → R → ε
  flow();                          // ε_p
  m_economy.finish_step(m_state);  // what the next step may leave out
  m_error.finish_step(load, m_state);
  find_surface(result);
  return StepStatus::ok();
}

}  // namespace argil::sim
