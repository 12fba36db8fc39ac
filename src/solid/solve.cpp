#include "base/check.h"
#include "solid/solid.h"

namespace argil::solid {

bool Solid::factorise() {
  if (!m_factor) m_factor = std::make_unique<linear::CholeskyFactor>(m_matrix);
  ++m_counters.factorisations;
  m_factor_valid = m_factor->factorise(m_matrix);
  return m_factor_valid;
}

StepStatus Solid::solve(SolidState& state, Tick tick) {
  if (num_free() == 0) return StepStatus::ok();
  for (int row = 0; row < num_free(); ++row)
    m_velocity.col(row) = state.v.col(m_vertex_of_row[static_cast<std::size_t>(row)]);

  const auto not_positive = [&] {
    return StepStatus::failed({tick, "solid", -1, "system matrix is not positive definite, pivot", 0.0, 0.0});
  };
  linear::SolveReport report;
  switch (m_params.solver) {
    case SolverKind::cholesky:
      if (!factorise()) return not_positive();
      m_factor->solve(m_rhs, m_velocity);
      report = {true, 1, 0.0};
      break;
    case SolverKind::pcg_jacobi:
      m_jacobi.update(m_matrix);
      report = m_cg.solve(m_matrix, m_jacobi, m_rhs, m_params.solver_tolerance,
                          m_params.solver_max_iterations, m_threads, m_velocity);
      break;
    case SolverKind::pcg_cholesky: {
      // The kept factor is renewed when the last solve with it was slow: the matrix has moved away from it.
      if ((!m_factor_valid || m_counters.iterations > m_params.refactor_iterations) && !factorise())
        return not_positive();
      linear::StaleCholesky stale(*m_factor);
      report = m_cg.solve(m_matrix, stale, m_rhs, m_params.solver_tolerance, m_params.solver_max_iterations,
                          m_threads, m_velocity);
      break;
    }
  }
  m_counters.iterations = report.iterations;
  m_counters.residual = report.relative_residual;
  if (!report.converged)
    return StepStatus::failed({tick, "solid", -1, "relative residual of the linear solve",
                               report.relative_residual, m_params.solver_tolerance});
  for (int row = 0; row < num_free(); ++row)
    state.v.col(m_vertex_of_row[static_cast<std::size_t>(row)]) = m_velocity.col(row);
  return StepStatus::ok();
}

}  // namespace argil::solid
