#include "sim/simulation.h"

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace argil::sim {

Simulation::Simulation(Body body, const mesh::TriangleMesh& tool, const Params& params,
                       const device::DeviceSample& start)
    : m_params(params),
      m_tool(tool),
      m_sides(std::make_unique<Sides>(std::move(body), m_tool, m_params, start)),
      m_result(body_side().surface().num_vertices()) {
  hand().place_surface(surface_now());
}

void Simulation::set_sides(std::unique_ptr<Sides> sides) {
  m_sides = std::move(sides);
  m_result = StepResult(body_side().surface().num_vertices());
  observe_stages(m_observer);
}

std::unique_ptr<Simulation::Sides> Simulation::make_next_sides(Body body, const RemappedState& clay) {
  auto sides = std::make_unique<Sides>(std::move(body), m_tool, m_params, device::DeviceSample{});
  sides->body.go_on_from(body_side(), clay);
  Points x;
  sides->body.surface().find_positions(sides->body.state().solid.x, x);
  sides->hand.go_on_from(hand(), x);
  return sides;
}

bool Simulation::renew_cells(Body body) {
  constexpr double kLeastVolume = 0.05;  // of a tet, over that at rest
  constexpr double kSettled = 0.1;       // of a stress, beyond the strength
  const RemappedState clay = remap(this->body(), solid(), body_state().solid.x, pore_water().saturation(),
                                   body_side().find_flow(), body);
  const double most = 1.0 / std::max(kLeastVolume, m_params.solid.min_volume_ratio);
  if (!clay.elastic.allFinite() || !(body.rest_volume_ratio.maxCoeff() < most)) return false;
  std::unique_ptr<Sides> sides = make_next_sides(std::move(body), clay);
  const bool has_own_surface = sides->body.body().touched.num_triangles() > 0;
  if (const std::vector<PressedPoint> pressed = hand().find_pressed(); has_own_surface && !pressed.empty()) {
    Body laid = sides->body.body();
    laid.touched = {sides->hand.put_under_tool(pressed, sides->hand.surface_x()),
                    sides->body.surface().triangles()};
    laid.touched_embedding =
        embed::make_embedding(laid.mesh, laid.touched.vertices, "the clay", embed::kAnyBeyond);
    sides = make_next_sides(std::move(laid), clay);
  }
  set_sides(std::move(sides));
  if (body_side().balance(hand().find_contact_force()) > kSettled) settle();
  body_side().set_flow(clay.flow);
  return true;
}

void Simulation::settle() {
  if (!hand().is_pressing()) return;
  hand().hand_over_still(m_load);
  if (!body_side().settle(m_load, m_result).is_ok()) {
    body_side().roll_back();
    hand().roll_back(nullptr);
    return;
  }
  body_side().commit();
  hand().feel_settled(m_result, surface_now());
}

void Simulation::restore_cells(Body body) {
  set_sides(std::make_unique<Sides>(std::move(body), m_tool, m_params, device::DeviceSample{}));
  hand().place_surface(surface_now());
}

StepStatus Simulation::tick(const device::DeviceSample& sample) {
  const bool is_due = clock().due(m_params.rates.physics_period_ticks);
  return tick(sample, {.begins_step = is_due, .waits_for_result = is_due});
}

StepStatus Simulation::tick(const device::DeviceSample& sample, const TickPlan& plan) {
  ARGIL_ASSERT(plan.begins_step == plan.waits_for_result || !m_params.deflects_between_steps());
  return sim::tick(hand(), *this, sample, plan, plan.waits_for_result ? &m_load : nullptr);
}

void Simulation::start_step(HandSide& hand) {
  hand.hand_over(m_load);
  m_step_status = body_side().step(m_load, m_result);
  if (m_step_status.is_ok() && m_result.has_moved) m_step_status = hand.update_compliance();
  if (m_step_status.is_ok())
    body_side().commit();
  else
    body_side().roll_back();
}

StepStatus Simulation::receive_step(HandSide& hand) {
  if (m_step_status.is_ok()) hand.receive(m_result);
  return m_step_status;
}

Frame Simulation::make_frame() {
  Frame frame = body_side().make_frame(hand().pose());
  frame.state_hash = state_hash();
  return frame;
}

StepStatus Simulation::find_equilibrium() {
  ARGIL_TRY(body_side().find_equilibrium());
  hand().place_surface(surface_now());
  return StepStatus::ok();
}

Points Simulation::surface_now() const {
  Points x;
  body_side().surface().find_positions(body_side().state().solid.x, x);
  return x;
}

bool Simulation::tool_overlaps_body() const {
  return hand().overlaps(surface_now());
}

}  // namespace argil::sim
