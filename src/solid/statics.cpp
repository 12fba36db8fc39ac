#include "solid/statics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "base/check.h"
#include "solid/body.h"
#include "solid/move.h"
#include "solid/newton.h"
#include "solid/solve.h"

namespace argil::solid {
namespace {

constexpr double kEnd = std::numeric_limits<double>::infinity();  // of time: supports at their full way

constexpr double kRoughTolerance = 1e-5;  // of the residual over loads and reactions

linear::SolverParams make_rough(linear::SolverParams solver) {
  solver.kind = linear::SolverKind::pcg_jacobi;
  solver.tolerance = 1e-2;  // of one of Newton's steps, of which some follow
  return solver;
}

/// Under the present share of the load, from state.x on.
StepStatus iterate(Body& body, const Part& whole, const StepLoads& loads, const SolidState& state,
                   linear::Solver& solver) {
  body.trial.x = state.x;
  body.prediction.x_hat = body.trial.x;
  body.trial.v.setZero();
  body.newton.iterations = 0;
  place_supports(body, kEnd, body.prediction.load_share);
  ARGIL_TRY(update_kinematics(body, whole, body.trial.x, {}, 0));
  while (!assemble_newton(body, whole, loads)) ARGIL_TRY(solve_newton(body, whole, loads, solver, 0));
  return StepStatus::ok();
}

void begin(Body& body, const StepLoads& loads, const SolidState& state, EquilibriumAccuracy accuracy) {
  body.plastic_strain = &state.plastic_strain;
  body.elastic.forget_all();
  body.is_state_changed = true;
  store_nodal_stiffness(body.model, body.materials, body.system);
  body.prediction.is_static = true;
  body.prediction.is_rough = accuracy != EquilibriumAccuracy::exact;
  body.prediction.keeps_matrix = accuracy == EquilibriumAccuracy::rough_again;
  body.prediction.tau = 1.0;
  body.prediction.v_hat.setZero();
  body.committed.v.setZero();
  body.committed.x = state.x;
  body.history.counters = {};
  body.newton.is_moved_by_load = false;
  body.contacts.start(loads.contacts, body.committed.v, 0.0);
}

/// Positions are rounded to ε |x|: far from the origin, or under a small load, no digit of a displacement is
/// left.
StepStatus check_resolution(const Body& body, const SolidState& state) {
  constexpr double kDigits = 100.0;
  const double bound = kDigits * std::numeric_limits<double>::epsilon() * state.x.cwiseAbs().maxCoeff();
  const double largest = std::sqrt((state.x - body.model.elements.rest).colwise().squaredNorm().maxCoeff());
  if (!body.newton.is_moved_by_load || largest >= bound) return StepStatus::ok();
  return StepStatus::failed(
      {0, "solid", -1,
       "largest displacement [m] under the loads, which the rounding of positions this far from "
       "the origin hides: move the body there, or give a larger load",
       largest, bound});
}

}  // namespace

StepStatus find_equilibrium(Body& body, const Part& whole, const StepLoads& loads, SolidState& state,
                            EquilibriumAccuracy accuracy) {
  constexpr double kSmallestShare = 1.0 / 1024.0;
  const SolidParams& params = body.model.params;
  const bool is_exact = accuracy == EquilibriumAccuracy::exact;
  const std::unique_ptr<linear::Solver> solver = linear::make_solver(
      is_exact ? make_exact(params.solver) : make_rough(params.solver), body.model.threads);
  body.newton.tolerance = is_exact ? params.newton_tolerance : kRoughTolerance;
  begin(body, loads, state, accuracy);
  double done = 0.0;
  for (double step = 1.0; done < 1.0;) {
    body.prediction.load_share = std::min(1.0, done + step);
    const StepStatus status = iterate(body, whole, loads, state, *solver);
    if (status.is_ok()) {
      done = body.prediction.load_share;
      state.x = body.trial.x;
      step *= 2.0;
      continue;
    }
    body.prediction.keeps_matrix = false;
    step *= 0.5;
    if (step < kSmallestShare) {
      const StepStatus last_good = update_kinematics(body, whole, state.x, {}, 0);  // what records describe
      ARGIL_ASSERT(last_good.is_ok());
      Failure failure = status.failure();
      char share[16];
      std::snprintf(share, sizeof share, "%.4g", done);
      failure.quantity += std::string(" (the last good state carries ") + share + " of the load), which";
      return StepStatus::failed(std::move(failure));
    }
  }
  return check_resolution(body, state);
}

}  // namespace argil::solid
