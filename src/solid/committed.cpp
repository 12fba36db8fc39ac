#include "solid/committed.h"

#include <algorithm>

#include "solid/frame_lag.h"
#include "solid/move.h"
#include "solid/response.h"
#include "solid/solve.h"

namespace argil::solid {
namespace {

/// Places and speeds of the nodes of `part`, and all that bdf2 remembers.
void copy_motion(const Part& part, const SolidState& from, SolidState& to) {
  part.nodes.each(from.x.cols(), [&](std::ptrdiff_t n) {
    to.x.col(n) = from.x.col(n);
    to.v.col(n) = from.v.col(n);
  });
  to.x_before = from.x_before;
  to.v_before = from.v_before;
}

/// Copies what has moved and flowed to the committed state.
void copy_to_committed(Body& body, const Part& part, const SolidState& state,
                       const std::vector<char>& is_flowing) {
  copy_motion(part, state, body.committed);
  const std::ptrdiff_t Q = body.model.elements.points_per_tet;
  part.batches.each(body.model.elements.num_tets(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (is_flowing.empty() || is_flowing[static_cast<std::size_t>(begin / kLanes)] != 0)
      body.committed.plastic_strain.middleCols(Q * begin, Q * (end - begin)) =
          state.plastic_strain.middleCols(Q * begin, Q * (end - begin));
  });
}

/// Rows of the matrix, elastic strains and sums of energies are those of another state.
void mark_all_changed(Body& body) {
  body.system.mark_all_changed();
  std::fill(body.energies.is_batch_new.begin(), body.energies.is_batch_new.end(), char{1});
  body.elastic.forget_all();
}

void serialize_solvers(Archive& archive, Body& body) {
  SolverHistory& history = body.history;
  System& system = body.system;
  archive.number("solid/newton_iterations", history.counters.newton_iterations);
  archive.number("solid/linear_iterations", history.counters.linear_iterations);
  archive.number("solid/residual", history.counters.residual);
  bool stores_nodal = system.has_nodal_blocks(body.materials);
  archive.number("solid/stores_nodal", stores_nodal);
  if (stores_nodal) store_nodal_stiffness(body.model, body.materials, system);
  history.solver->serialize(archive, "solver/", system.matrix);
  bool has_response_solver = history.response_solver != nullptr;
  archive.number("response/is_known", has_response_solver);
  if (!has_response_solver) return;
  make_response_solver(body);
  history.response_solver->serialize(archive, "response/", system.matrix);
}

}  // namespace

void set_start(Body& body, ActiveRegion& region, const SolidState& state) {
  const Part& part = region.start_part();
  copy_motion(part, state, body.committed);
  body.plastic_strain = &state.plastic_strain;
  start_from_committed(body, part);
  region.set_start_known();
  body.is_state_changed = true;
}

void make_ready(Body& body, ActiveRegion& region, const SolidState& state, const Points& force) {
  set_start(body, region, state);
  body.is_state_changed = false;
  region.make_ready(force);
  if (!body.is_explicit()) body.history.solver->prepare(body.system.matrix);
}

void commit(Body& body, ActiveRegion& region, const SolidState& state, const std::vector<char>& is_flowing) {
  if (body.is_state_changed || !region.is_start_known())
    copy_to_committed(body, region.start_part(), state, is_flowing);
  body.kinematics.commit();
  body.history.commit(body.system.has_nodal_blocks(body.materials));
  region.commit();
  body.is_state_changed = false;
}

void forget(Body& body, ActiveRegion& region) {
  region.forget();
  mark_all_changed(body);
}

StepStatus roll_back(Body& body, ActiveRegion& region, SolidState& state, Tick tick) {
  state = body.committed;
  if (!body.history.committed.has_nodal_blocks) drop_nodal_stiffness(body.model, body.materials, body.system);
  body.history.roll_back(body.system.matrix);
  region.roll_back();
  mark_all_changed(body);
  body.is_state_changed = false;
  body.kinematics.roll_back(body.materials.gradient());
  return restore_kinematics(body, region, state.x, tick);
}

void serialize(Archive& archive, Body& body, ActiveRegion& region, SolidState& state) {
  archive.array("solid/x", state.x);
  archive.array("solid/v", state.v);
  archive.array("solid/plastic_strain", state.plastic_strain);
  archive.any_size("solid/x_before", state.x_before);
  archive.any_size("solid/v_before", state.v_before);
  const Archive::History of_solves(archive);
  serialize_solvers(archive, body);
  region.serialize(archive);
  if (archive.is_restoring()) forget(body, region);
  FrameLag& lag = body.history.frame_lag;
  archive.number("solid/frame_slack", lag.slack);
  archive.number("solid/frame_error", lag.left);
  archive.number("solid/frame_lag_speed", lag.lag_speed);
  archive.number("solid/frame_error_steps", lag.steps);
  if (has_lagging_frames(body.model)) body.kinematics.serialize_frames(archive);
}

StepStatus restore_kinematics(Body& body, const ActiveRegion& region, const Points& x, Tick tick) {
  const FrameUpdate frames{find_frame_tolerance(body), has_lagging_frames(body.model)};
  return update_kinematics(body, region.start_part(), x, frames, tick);
}

}  // namespace argil::solid
