#include "sim/simulation.h"

#include <utility>

namespace argil::sim {

Simulation::Simulation(Body body, const mesh::TriangleMesh& tool, const Params& params,
                       const device::DeviceSample& start)
    : m_params(params),
      m_body_side(std::move(body), m_params),
      m_hand(tool, m_params, m_body_side.surface(), m_body_side.solid().elements(), start),
      m_load(m_body_side.solid().elements().num_nodes()),
      m_answer(m_body_side.surface().num_vertices()) {
  m_hand.place_surface(surface_now());
}

StepStatus Simulation::settle() {
  ARGIL_TRY(m_body_side.settle());
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
