#include "solid/body.h"

#include <utility>

#include "solid/frame_lag.h"
#include "solid/solve.h"

namespace argil::solid {

Body::Body(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
           const SolidParams& params, int threads)
    : model(mesh, topology, std::move(supports), params, threads),
      materials(model),
      committed(make_rest_state(model)),
      trial(committed),
      kinematics(model.elements, params.model, has_lagging_frames(model), model.has_deformed_frames()),
      elastic(model.elements, model.has_logarithmic_points()),
      system(model, materials),
      energies(model.elements) {
  const Eigen::Index num_nodes = model.elements.num_nodes();
  prediction.x_hat = prediction.held_x = committed.x;
  prediction.v_hat = committed.v;
  forces.corner.setZero(3, model.elements.nodes.size() + 1);
  if (model.elements.points_per_tet > 1) forces.of_points.setZero(3, 4 * model.elements.num_points());
  forces.internal.setZero(3, num_nodes);
  scratch.product.setZero(3, num_nodes);
  scratch.left.resize(3, model.num_free());
  scratch.correction.resize(3, model.num_free());
  contacts.search.delta.resize(3, model.num_free());
  if (may_lag_further(*this)) make_room_for_lag(*this);
  history.solver = linear::make_solver(
      params.iteration == Iteration::newton ? make_exact(params.solver) : params.solver, threads);
  history.commit(system.has_nodal_blocks(materials));
}

SolidState make_rest_state(const Model& model) {
  SolidState state;
  state.x = model.elements.rest;
  state.v.setZero(3, model.elements.num_nodes());
  state.plastic_strain.setZero(6, model.elements.num_points());
  return state;
}

}  // namespace argil::solid
