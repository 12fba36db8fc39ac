#include "sim/simulation.h"

#include <utility>

#include "base/check.h"

namespace argil::sim {

Simulation::Simulation(Body body, const mesh::TriangleMesh& tool, const Params& params,
                       const device::DeviceSample& start)
    : m_params(params),
      m_body_side(std::move(body), m_params),
      m_hand(tool, m_params, m_body_side.surface(), m_body_side, start),
      m_result(m_body_side.surface().num_vertices()) {
  m_hand.place_surface(surface_now());
}

StepStatus Simulation::tick(const device::DeviceSample& sample) {
  const bool is_due = clock().due(m_params.rates.physics_period_ticks);
  return tick(sample, {.begins_step = is_due, .waits_for_result = is_due});
}

StepStatus Simulation::tick(const device::DeviceSample& sample, const TickPlan& plan) {
  ARGIL_ASSERT(plan.begins_step == plan.waits_for_result ||
               m_params.rates.between_frames != BetweenFrames::compliant);
  return sim::tick(m_hand, *this, sample, plan, plan.waits_for_result ? &m_load : nullptr);
}

void Simulation::start_step(HandSide& hand) {
  hand.hand_over(m_load);
  m_step_status = m_body_side.step(m_load, m_result);
  if (m_step_status.is_ok() && m_result.has_moved) m_step_status = hand.update_compliance();
  if (m_step_status.is_ok())
    m_body_side.commit();
  else
    m_body_side.roll_back();
}

StepStatus Simulation::receive_step(HandSide& hand) {
  if (m_step_status.is_ok()) hand.receive(m_result);
  return m_step_status;
}

Frame Simulation::make_frame() {
  Frame frame = m_body_side.make_frame(m_hand.pose());
  frame.state_hash = state_hash();
  return frame;
}

StepStatus Simulation::find_equilibrium() {
  ARGIL_TRY(m_body_side.find_equilibrium());
  m_hand.place_surface(surface_now());
  return StepStatus::ok();
}

Points Simulation::surface_now() const {
  Points x;
  m_body_side.surface().find_positions(m_body_side.state().solid.x, x);
  return x;
}

bool Simulation::tool_overlaps_body() const {
  return m_hand.overlaps(surface_now());
}

}  // namespace argil::sim
