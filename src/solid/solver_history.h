#pragma once

#include <memory>

#include "linear/solver.h"

namespace argil::solid {

/// What the last step took; statics: with all its shares of the load, those that failed included.
struct StepCounters {
  int newton_iterations = 0;
  int linear_iterations = 0;
  bool has_solved = false;  ///< by iterations or a factor; not where the first guess would do
  double residual = 0.0;    ///< relative, of the last linear solve
  double imbalance = 0.0;   ///< [N] that a solve left, with a slack also frames that lag: norm over all nodes
  int assembled_rows = 0;   ///< rows of the matrix that were gathered anew; the others stayed as they were
};

/// How far the frames of the matrix may lag behind the rotations where a step has slack, and what they left.
struct FrameLag {
  double slack = 0.0;      ///< on ‖R − Q‖
  double left = 0.0;       ///< by frames that lag, in terms of the right-hand side, as it was last found
  double lag_speed = 0.0;  ///< and their lag times the body's speed then
  int steps = 0;           ///< for so many more it is not found anew
};

/// What solves take from earlier ones. Each solver keeps a factor of its own.
struct SolverHistory {
  std::unique_ptr<linear::Solver> solver;
  std::unique_ptr<linear::Solver> response_solver;  ///< made at first use
  FrameLag frame_lag;
  StepCounters counters;

  /// Solves since the last commit count from now on; or they never were. `has_nodal_blocks`: p1_nodal, the
  /// matrix holds the nodes' stiffness. `pattern`: of the system's matrix.
  void commit(bool has_nodal_blocks);
  void roll_back(const linear::BlockMatrix& pattern);

  struct {
    FrameLag frame_lag;
    StepCounters counters;
    bool has_response_solver = false;
    bool has_nodal_blocks = false;
  } committed;
};

}  // namespace argil::solid
