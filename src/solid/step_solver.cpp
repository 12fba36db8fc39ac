// How exactly a step is solved, and for which part of the body.

#include "solid/step_solver.h"

#include <algorithm>
#include <cmath>

#include "solid/committed.h"
#include "solid/contact_search.h"
#include "solid/frame_lag.h"
#include "solid/matrix.h"
#include "solid/momentum.h"
#include "solid/move.h"
#include "solid/newton.h"
#include "solid/solve.h"
#include "solid/unloading.h"

namespace argil::solid {
namespace {

/// The solves of a step with one linearisation.
class OneStep {
 public:
  OneStep(Body& body, ActiveRegion& region, const StepLoads& loads, bool is_first)
      : m_body(body),
        m_region(region),
        m_loads(loads),
        m_product(body, region.part(), loads.contacts),
        m_is_first(is_first) {}

  linear::SolveReport solve() {
    if (m_body.model.num_free() == 0) return {true, 0, 0.0};
    guess(m_body, m_region.part(), m_is_first);
    linear::Solver& solver = *m_body.history.solver;
    const double slack = m_body.prediction.tau * m_loads.slack;
    solver.set_goal(m_is_first ? slack : std::max(slack, find_enough(m_body)));
    const bool follows_force = m_region.is_used() && m_loads.region_slack > 0.0;
    if (follows_force) m_region.grow_by_force(m_loads);
    linear::SolveReport report = solve_once();
    if (m_is_first) m_body.newton.solve_scale = report.first;
    solver.set_goal(slack);
    if (follows_force) follow_force(report);
    const bool is_number = report.iterations > 0 || !std::isnan(report.relative_residual);
    if (!report.converged && is_number && m_region.is_used()) {  // of the whole, where a factor may do
      m_region.leave(m_loads);
      solve_anew(report);
    }
    if (report.wants_stored) {
      store_nodal_stiffness(m_body.model, m_body.materials, m_body.system);
      assemble_matrix(m_body, m_region.part(), m_loads.contacts);
      solve_anew(report);
    }
    count_solve(m_body, report);
    return report;
  }

 private:
  linear::SolveReport solve_once() {
    System& system = m_body.system;
    return m_body.history.solver->solve(system.matrix, m_product, system.rhs, system.delta);
  }
  /// What the solution pulls at and the hand would feel moves, too: some layers of it in a blow, none as a
  /// rule.
  void follow_force(linear::SolveReport& report) {
    constexpr int kMostLayers = 16;
    for (int i = 0; i < kMostLayers && report.converged && m_region.grow_by_force(m_loads); ++i) {
      const int before = report.iterations;
      report = solve_once();
      report.iterations += before;
    }
  }
  void solve_anew(linear::SolveReport& report) {
    const int before = report.iterations;
    guess(m_body, m_region.part(), true);
    report = solve_once();
    report.iterations += before;
    if (m_is_first) m_body.newton.solve_scale = report.first;
  }

  Body& m_body;
  ActiveRegion& m_region;
  const StepLoads& m_loads;
  Product m_product;
  bool m_is_first;
};

/// At the first guess a stiff contact presses with many times the force that it ends with. What a solve
/// leaves is to be small beside that force, too, or beside the one that the step began with.
void limit_solve_scale(Body& body, std::span<const PointStiffness> contacts) {
  if (contacts.empty()) return;
  const double force = find_contact_norm(body, contacts);
  body.newton.solve_scale = std::min(body.newton.solve_scale, body.prediction.tau * force);
}

/// The step is to be solved once more about where it came to, from the contacts that it has. False where it
/// has been, is not asked for, or the body would turn inside out there.
bool begin_follow_up(Body& body, const ActiveRegion& region, const StepLoads& loads, Tick tick) {
  if (!loads.follows_turns || body.newton.is_follow_up) return false;
  body.newton.is_follow_up = true;
  if (!update_kinematics(body, region, body.trial.x, tick).is_ok()) return false;
  body.newton.has_moved = true;
  body.contacts.go_on();
  body.system.delta.setZero();
  return true;
}

StepStatus solve_one_step(Body& body, ActiveRegion& region, const StepLoads& loads, Tick tick, bool& solved) {
  const bool is_first = body.newton.iterations++ == 0;
  ++body.history.counters.newton_iterations;
  const linear::SolveReport report = OneStep(body, region, loads, is_first).solve();
  if (!report.converged) return describe_failure(report, body.model.params.solver.tolerance, tick);
  const bool balances = !region.is_used() && !linear::is_direct(body.model.params.solver.kind);
  if (balances) balance_momentum(body, region.part(), loads.contacts);
  set_iterate(body, region.part(), 1.0);
  // Contacts and flow may leave undone what the solve may; where there is slack, that has taken all of it.
  constexpr double kMostLeft = 2e-4;  // of what presses
  const double tolerance = loads.slack > 0.0 ? 0.0 : body.model.params.solver.tolerance;
  limit_solve_scale(body, loads.contacts);
  const double enough = std::max(body.prediction.tau * loads.slack, find_enough(body));
  const auto settle = [&] {
    return settle_contacts(body, region.part(), loads.contacts, std::min(kMostLeft, tolerance));
  };
  solved =
      settle() && (body.contacts.search.has_given_up || report.relative_residual * report.first <= enough);
  if (solved && loads.slack > 0.0 && correct_solution(body, region.part(), loads)) {
    if (balances) balance_momentum(body, region.part(), loads.contacts);
    set_iterate(body, region.part(), 1.0);
    solved = settle();
  }
  solved = solved && !find_unloading(body, region.part(), tolerance * body.newton.solve_scale);
  if (!solved)
    set_iterate(body, region.part(), 0.0);  // the same step anew
  else
    solved = !begin_follow_up(body, region, loads, tick);
  return StepStatus::ok();
}

}  // namespace

StepStatus update_kinematics(Body& body, const ActiveRegion& region, const Points& x, Tick tick) {
  const FrameUpdate frames{find_frame_tolerance(body), false};
  return update_kinematics(body, region.start_part(), x, frames, tick);
}

StepStatus begin_step(Body& body, ActiveRegion& region, const SolidState& state, const StepLoads& loads,
                      const StepTime& time) {
  set_start(body, region, state);
  const bool has_moved = predict(body, region.part(), loads, time.length, time.end);
  return has_moved ? update_kinematics(body, region, body.trial.x, time.tick) : StepStatus::ok();
}

bool assemble(Body& body, ActiveRegion& region, const StepLoads& loads) {
  if (body.is_newton() && !body.is_explicit()) return assemble_newton(body, region.part(), loads);
  region.wake(loads);
  assemble_residual(body, region.part(), loads);
  if (body.is_explicit()) return false;
  if (body.newton.iterations == 0) begin_unloading(body, region.part());
  body.system.is_projected = true;
  assemble_matrix(body, region.part(), loads.contacts);
  region.grow_by_speed(loads);
  return false;
}

double compute_imbalance(const Body& body, const ActiveRegion& region, const StepLoads& loads) {
  const Field& mass = body.materials.mass();
  return std::sqrt(region.part().nodes.sum(mass.size(), [&](std::ptrdiff_t n) {
    if (!region.is_awake(n)) return 0.0;
    const Vec3 momentum_rate = mass(n) / body.prediction.tau * body.committed.v.col(n);
    return (find_imbalance(body, loads, n) + momentum_rate).squaredNorm();
  }));
}

StepStatus solve(Body& body, ActiveRegion& region, const StepLoads& loads, Tick tick, bool& solved) {
  const Part& part = region.part();
  part.nodes.each(body.trial.v.cols(),
                  [&](std::ptrdiff_t n) { body.system.v_base.col(n) = body.trial.v.col(n); });
  solved = !body.is_newton() || body.is_explicit();
  if (body.is_explicit()) {
    solve_explicit(body, part);
    return StepStatus::ok();
  }
  if (body.is_newton()) return solve_newton(body, part, loads, *body.history.solver, tick);
  return solve_one_step(body, region, loads, tick, solved);
}

}  // namespace argil::solid
