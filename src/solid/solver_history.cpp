#include "solid/solver_history.h"

namespace argil::solid {

void SolverHistory::commit(bool has_nodal_blocks) {
  solver->commit();
  if (response_solver) response_solver->commit();
  committed.frame_lag = frame_lag;
  committed.counters = counters;
  committed.has_response_solver = response_solver != nullptr;
  committed.has_nodal_blocks = has_nodal_blocks;
}

void SolverHistory::roll_back(const linear::BlockMatrix& pattern) {
  solver->roll_back(pattern);
  if (!committed.has_response_solver) response_solver.reset();
  if (response_solver) response_solver->roll_back(pattern);
  frame_lag = committed.frame_lag;
  counters = committed.counters;
}

}  // namespace argil::solid
