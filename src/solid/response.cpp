#include "solid/response.h"

#include <algorithm>

#include <Eigen/LU>

#include "base/check.h"
#include "solid/body.h"
#include "solid/matrix.h"
#include "solid/product.h"
#include "solid/solve.h"

namespace argil::solid {

namespace {

linear::SolverParams find_response_params(const Body& body) {
  linear::SolverParams params = body.model.params.solver;
  params.tolerance = std::min(params.tolerance, body.model.params.response_tolerance);
  return params;
}

}  // namespace

void make_response_solver(Body& body) {
  if (!body.history.response_solver)
    body.history.response_solver = linear::make_solver(find_response_params(body), body.model.threads);
}

void prepare_response(Body& body, const Part& part, const SolidState& state, double step_s) {
  ARGIL_ASSERT(!body.is_explicit());
  body.plastic_strain = &state.plastic_strain;
  body.elastic.forget_all();
  store_nodal_stiffness(body.model, body.materials, body.system);  // pairs solve exactly
  body.prediction.is_static = false;
  body.prediction.tau = compute_tau(body.model.params.integrator, step_s);
  body.system.is_projected = true;
  keep_damping_frame(body);
  update_volume_change(body.strained(), body.forces.volume);
  assemble_matrix(body, part, {});
  // Between two steps that is no part of one that might be taken back.
  if (!body.is_state_changed)
    body.history.committed.has_nodal_blocks = body.system.has_nodal_blocks(body.materials);
}

StepStatus find_response(Body& body, const Part& part, const Points& force, Tick tick, Points& displacement) {
  const Model& model = body.model;
  System& system = body.system;
  make_response_solver(body);
  body.history.response_solver->restrict_to(part.rows.list());
  displacement = force;
  clear_held(model, displacement);
  const double tau = body.prediction.tau;
  for (int r = 0; r < model.num_free(); ++r)
    system.rhs.col(r) = tau * tau * displacement.col(model.node_of_row[static_cast<std::size_t>(r)]);
  displacement.setZero();
  if (system.rhs.isZero(0.0)) return StepStatus::ok();
  system.delta.setZero();
  Product product(body, part, {});
  const linear::SolveReport report =
      body.history.response_solver->solve(system.matrix, product, system.rhs, system.delta);
  if (!report.converged)
    return StepStatus::failed({tick, "solid", -1, "relative residual of the compliance's solve",
                               report.relative_residual, find_response_params(body).tolerance});
  for (int r = 0; r < model.num_free(); ++r)
    displacement.col(model.node_of_row[static_cast<std::size_t>(r)]) = system.delta.col(r);
  clear_held(model, displacement);
  return StepStatus::ok();
}

Mat3 compute_local_response(const Body& body, int node) {
  const int row = body.model.row_of_node[static_cast<std::size_t>(node)];
  if (row < 0) return Mat3::Zero();
  const double tau = body.prediction.tau;
  const linear::BlockMatrix& matrix = body.system.matrix;
  Mat3 response = tau * tau * Mat3(matrix.block(matrix.diagonal[static_cast<std::size_t>(row)])).inverse();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (body.model.constraints.support(axis, node) >= 0) response(axis, axis) = 0.0;
  return response;
}

}  // namespace argil::solid
