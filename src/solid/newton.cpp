#include "solid/newton.h"

#include "solid/body.h"
#include "solid/contact_search.h"
#include "solid/matrix.h"
#include "solid/product.h"
#include "solid/solve.h"

namespace argil::solid {
namespace {

linear::SolveReport solve_system(Body& body, const Part& part, const StepLoads& loads, linear::Solver& solver,
                                 bool is_first) {
  if (body.model.num_free() == 0) return {true, 0, 0.0};
  guess(body, part, is_first);
  Product product(body, part, loads.contacts);
  solver.set_goal(0.0);
  const linear::SolveReport report =
      solver.solve(body.system.matrix, product, body.system.rhs, body.system.delta);
  if (is_first) body.newton.solve_scale = report.first;
  count_solve(body, report);
  return report;
}

}  // namespace

bool assemble_newton(Body& body, const Part& part, const StepLoads& loads) {
  NewtonMeasures& newton = body.newton;
  if (body.contacts.are_alone && body.has_implicit_contact())
    choose_alone(body.step_contacts(loads.contacts), body.trial.x, body.contacts);
  assemble_residual(body, part, loads);
  // At least one solve where something acts: what it does may be small beside the rounding of stiffer parts.
  const bool may_end = newton.iterations > 0 || !newton.is_driven;
  if (may_end && compute_excess(body) <= newton.tolerance * newton.residual_scale) {
    const StepContacts contacts = body.step_contacts(loads.contacts);
    const auto update = body.contacts.are_alone ? update_friction : update_active_contacts;
    if (!body.has_implicit_contact() || !update(contacts, body.trial.x, body.contacts)) return true;
    newton.iterations = 1;  // of the next round; not the step's first
    assemble_residual(body, part, loads);
  }
  newton.is_moved_by_load = true;
  newton.potential = compute_potential(body, part, loads);
  if (body.prediction.is_static && body.prediction.keeps_matrix) return false;
  body.system.is_projected = false;
  assemble_matrix(body, part, loads.contacts);
  body.prediction.keeps_matrix = body.prediction.is_rough;
  return false;
}

StepStatus solve_newton(Body& body, const Part& part, const StepLoads& loads, linear::Solver& solver,
                        Tick tick) {
  NewtonMeasures& newton = body.newton;
  const bool is_first = newton.iterations++ == 0;
  ++body.history.counters.newton_iterations;
  linear::SolveReport report = solve_system(body, part, loads, solver, is_first);
  const auto leads_downhill = [&] {
    return report.converged && body.system.rhs.cwiseProduct(body.system.delta).sum() >= 0.0;
  };
  if (needs_tangents(body) && !leads_downhill()) {
    // The true matrix has negative modes here, so that its step need not lead downhill.
    body.system.is_projected = true;
    assemble_matrix(body, part, loads.contacts);
    report = solve_system(body, part, loads, solver, is_first);
  }
  const SolidParams& params = body.model.params;
  if (!report.converged) return describe_failure(report, make_exact(params.solver).tolerance, tick);
  if (newton.iterations > params.newton_max_iterations)
    return StepStatus::failed({tick, "solid", -1, "Newton's relative residual",
                               compute_excess(body) / newton.residual_scale, newton.tolerance});
  return search_line(body, part, loads, tick);
}

}  // namespace argil::solid
