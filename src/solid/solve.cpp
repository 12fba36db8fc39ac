// From δ to the next iterate.

#include "solid/solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/ordered_sum.h"
#include "solid/body.h"
#include "solid/move.h"

namespace argil::solid {

linear::SolverParams make_exact(linear::SolverParams solver) {
  constexpr double kTolerance = 1e-8;
  solver.tolerance = std::min(solver.tolerance, kTolerance);
  return solver;
}

void guess(Body& body, const Part& part, bool is_anew) {
  const Model& model = body.model;
  Points& delta = body.system.delta;
  if (body.is_newton()) delta.setZero();
  if (is_anew)
    part.near_rows.each(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t row = begin; row < end; ++row) {
        const int n = model.node_of_row[static_cast<std::size_t>(row)];
        delta.col(row) = body.committed.v.col(n) - body.trial.v.col(n);
      }
    });
  for (const int row : model.held_rows)
    for (int k = 0; k < 3; ++k)
      if (model.constraints.support(k, model.node_of_row[static_cast<std::size_t>(row)]) >= 0)
        delta(k, row) = 0.0;
}

double find_enough(const Body& body) {
  return body.model.params.solver.tolerance * body.newton.solve_scale;
}

void count_solve(Body& body, const linear::SolveReport& report) {
  StepCounters& counters = body.history.counters;
  counters.linear_iterations += report.iterations;
  counters.has_solved |= report.iterations > 0 || linear::is_direct(body.model.params.solver.kind);
  counters.residual = report.relative_residual;
  counters.imbalance = report.relative_residual * report.first / body.prediction.tau;
}

void set_iterate(Body& body, const Part& part, double share) {
  const Model& model = body.model;
  const Prediction& step = body.prediction;
  const System& system = body.system;
  SolidState& trial = body.trial;
  part.rows.each(model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      const int n = model.node_of_row[static_cast<std::size_t>(row)];
      trial.v.col(n) = system.v_base.col(n) + share * system.delta.col(row);
      trial.x.col(n) = step.x_hat.col(n) + step.tau * trial.v.col(n);
    }
  });
  for (const auto& [n, k] : model.placed_components) {
    trial.v(k, n) = system.v_base(k, n);
    trial.x(k, n) = step.held_x(k, n);
  }
}

void solve_explicit(Body& body, const Part& part) {
  System& system = body.system;
  for (int row = 0; row < body.model.num_free(); ++row)
    system.delta.col(row) =
        system.rhs.col(row) / body.materials.mass()(body.model.node_of_row[static_cast<std::size_t>(row)]);
  body.history.counters.has_solved = true;
  set_iterate(body, part, 1.0);
}

StepStatus search_line(Body& body, const Part& part, const StepLoads& loads, Tick tick) {
  constexpr double kPromised = 1e-4;
  constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
  constexpr int kHalvings = 40;
  const Points& rhs = body.system.rhs;
  const Points& delta = body.system.delta;
  const double slope =
      -ordered_sum(rhs.cols(), [&](std::ptrdiff_t i) { return rhs.col(i).dot(delta.col(i)); });
  const double before = body.newton.potential;
  const double rounding = body.newton.potential_rounding + kRounding * body.newton.potential_scale;
  body.system.v_base = body.trial.v;
  FrameUpdate frames;
  frames.keeps_frames = body.prediction.kept_rotation.size() > 0;
  double share = 1.0;
  StepStatus status = StepStatus::ok();
  for (int i = 0; i <= kHalvings; ++i, share *= 0.5) {
    set_iterate(body, part, share);
    status = update_kinematics(body, part, body.trial.x, frames, tick);
    if (!status.is_ok()) continue;
    update_volume_change(body.strained(), body.forces.volume);
    const double after = compute_potential(body, part, loads);
    if (after <= before + kPromised * share * slope + rounding) return StepStatus::ok();
  }
  if (!status.is_ok()) return status;
  return StepStatus::failed({tick, "solid", -1, "line search: slope of the potential", slope, 0.0});
}

StepStatus describe_failure(const linear::SolveReport& report, double tolerance, Tick tick) {
  if (std::isinf(report.relative_residual))
    return StepStatus::failed({tick, "solid", -1, "system matrix is not positive definite, pivot", 0.0, 0.0});
  return StepStatus::failed(
      {tick, "solid", -1, "relative residual of the linear solve", report.relative_residual, tolerance});
}

}  // namespace argil::solid
