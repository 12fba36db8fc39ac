#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/ordered_sum.h"
#include "solid/solid.h"

namespace argil::solid {

/// A x for the present matrix: by its blocks, or tet by tet where the solver wants none stored.
class Solid::Product final : public linear::Operator {
 public:
  Product(Solid& solid, std::span<const PointStiffness> contacts) : m_solid(solid), m_contacts(contacts) {}

  double multiply(const Points& x, Points& y) override {
    if (!m_solid.has_only_diagonal()) {
      const double stored = linear::multiply(m_solid.m_matrix, x, y, m_solid.m_rows);
      return stored + (m_solid.m_nodal_product ? m_solid.m_nodal_product->add(x, y) : 0.0);
    }
    const MatrixShares share = m_solid.shares();
    Points& u = m_solid.m_direction;
    Points& force = m_solid.m_product;
    u.setZero(3, m_solid.m_elements.num_nodes());
    for (int row = 0; row < m_solid.num_free(); ++row)
      u.col(m_solid.m_node_of_row[static_cast<std::size_t>(row)]) = x.col(row);
    m_solid.clear_held(u);
    force.setZero(3, u.cols());
    m_solid.compute_stiffness_product(u, share.kept, share.exact, force);
    if (!m_solid.m_is_static && m_solid.m_params.implicit_contact)
      m_solid.add_contact_product(u, m_contacts, m_solid.m_tau * m_solid.m_tau, force);
    for (int row = 0; row < m_solid.num_free(); ++row) {
      const int n = m_solid.m_node_of_row[static_cast<std::size_t>(row)];
      y.col(row) = share.mass * m_solid.m_mass(n) * x.col(row) + force.col(n);
    }
    for (const int row : m_solid.m_held_rows) {
      const int n = m_solid.m_node_of_row[static_cast<std::size_t>(row)];
      for (int k = 0; k < 3; ++k)
        if (m_solid.m_constraints.support(k, n) >= 0)
          y(k, row) = m_solid.m_matrix.block(m_solid.m_matrix.diagonal[static_cast<std::size_t>(row)])(k, k) *
                      x(k, row);
    }
    return ordered_sum(x.size(), [&](std::ptrdiff_t i) { return x(i) * y(i); });
  }

  /// y = A x with the present rotations, where those of the stored matrix lag; rows that are solved for.
  void multiply_present(const Points& x, Points& y) {
    const MatrixShares share = m_solid.shares();
    Points& u = m_solid.m_direction;
    Points& force = m_solid.m_product;
    m_solid.each_node([&](std::ptrdiff_t n) {
      const int row = m_solid.m_row_of_node[static_cast<std::size_t>(n)];
      u.col(n) = row < 0 ? Vec3::Zero() : Vec3(x.col(row));
    });
    m_solid.clear_held(u);
    m_solid.compute_present_product(u, force);
    if (m_solid.m_params.implicit_contact)
      m_solid.add_contact_product(u, m_contacts, m_solid.m_tau * m_solid.m_tau / share.kept, force);
    m_solid.clear_held(force);
    m_solid.m_rows.each(m_solid.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t row = begin; row < end; ++row) {
        const int n = m_solid.m_node_of_row[static_cast<std::size_t>(row)];
        y.col(row) = share.mass * m_solid.m_mass(n) * x.col(row) + share.kept * force.col(n);
      }
    });
    m_solid.each_node(
        [&](std::ptrdiff_t n) { force.col(n).setZero(); });  // for nodes that wake within a step
  }

  bool has_unstored() const override { return m_solid.m_nodal_product != nullptr; }
  double add_unstored(const float* x, float* y) override {
    return m_solid.m_nodal_product ? m_solid.m_nodal_product->add(x, y) : 0.0;
  }
  void add_unstored_diagonal(Eigen::Matrix3Xd& blocks) override {
    if (m_solid.m_nodal_product) m_solid.m_nodal_product->add_diagonal(blocks);
  }

 private:
  Solid& m_solid;
  std::span<const PointStiffness> m_contacts;
};

void Solid::clear_held(Points& u) const {
  for (const int row : m_held_rows) {
    const int n = m_node_of_row[static_cast<std::size_t>(row)];
    for (int k = 0; k < 3; ++k)
      if (m_constraints.support(k, n) >= 0) u(k, n) = 0.0;
  }
}

StepStatus Solid::solve(const StepLoads& loads, Tick tick, bool& solved) {
  each_node([&](std::ptrdiff_t n) { m_v_base.col(n) = m_v.col(n); });
  solved = !is_newton() || is_explicit();
  if (is_explicit()) {
    for (int row = 0; row < num_free(); ++row)
      m_delta.col(row) = m_rhs.col(row) / m_mass(m_node_of_row[static_cast<std::size_t>(row)]);
    m_counters.has_solved = true;
    set_iterate(1.0);
    return StepStatus::ok();
  }
  const bool is_first = m_iterations++ == 0;
  ++m_counters.newton_iterations;
  linear::SolveReport report = solve_system(loads, is_first);
  if (is_newton() && needs_tangents() && !(report.converged && m_rhs.cwiseProduct(m_delta).sum() >= 0.0)) {
    // The true matrix has negative modes here, so that its step need not lead downhill.
    m_is_projected = true;
    assemble_matrix(loads.contacts);
    report = solve_system(loads, is_first);
  }
  if (!report.converged && std::isinf(report.relative_residual))
    return StepStatus::failed({tick, "solid", -1, "system matrix is not positive definite, pivot", 0.0, 0.0});
  if (!report.converged)
    return StepStatus::failed({tick, "solid", -1, "relative residual of the linear solve",
                               report.relative_residual,
                               (is_newton() ? make_exact(m_params.solver) : m_params.solver).tolerance});
  if (!is_newton()) {
    set_iterate(1.0);
    solved = !exchange_contacts(loads.contacts);
    if (solved && loads.slack > 0.0 && correct_solution(loads)) {
      set_iterate(1.0);
      solved = !exchange_contacts(loads.contacts);
    }
    if (!solved) set_iterate(0.0);  // the same step anew
    return StepStatus::ok();
  }
  if (m_iterations > m_params.newton_max_iterations)
    return StepStatus::failed({tick, "solid", -1, "Newton's relative residual",
                               compute_excess() / m_residual_scale, m_params.newton_tolerance});
  return search_line(loads, tick);
}

/// What Newton's method, statics and compliances ask of a solve: there its error does not go with the next
/// step, or another iteration costs more than what a loose solve saves.
linear::SolverParams Solid::make_exact(linear::SolverParams solver) {
  constexpr double kTolerance = 1e-8;
  solver.tolerance = std::min(solver.tolerance, kTolerance);
  return solver;
}

/// A δ = r. First guess: the body goes on as before; when contacts were exchanged, the step with the others.
linear::SolveReport Solid::solve_system(const StepLoads& loads, bool is_first) {
  if (num_free() == 0) return {true, 0, 0.0};
  const auto guess = [&](bool is_anew) {
    if (is_newton()) m_delta.setZero();
    if (is_anew)
      m_near_rows.each(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        for (std::ptrdiff_t row = begin; row < end; ++row) {
          const int n = m_node_of_row[static_cast<std::size_t>(row)];
          m_delta.col(row) = m_v_start.col(n) - m_v.col(n);
        }
      });
    for (const int row : m_held_rows)
      for (int k = 0; k < 3; ++k)
        if (m_constraints.support(k, m_node_of_row[static_cast<std::size_t>(row)]) >= 0)
          m_delta(k, row) = 0.0;
  };
  guess(is_first);
  Product product(*this, loads.contacts);
  if (m_is_static && !m_static_solver)
    m_static_solver = linear::make_solver(make_exact(m_params.solver), m_threads);
  linear::Solver& solver = m_is_static ? *m_static_solver : *m_solver;
  const double slack = is_newton() ? 0.0 : m_tau * loads.slack;
  // With other contacts the same step goes on: to where its first solve was to end.
  const bool goes_on = !is_first && !is_newton();
  solver.set_goal(goes_on ? std::max(slack, m_params.solver.tolerance * m_first_residual) : slack);
  const bool follows_force = m_region && !m_is_static && loads.region_slack > 0.0;
  if (follows_force) grow_region_by_force(loads);
  linear::SolveReport report = solver.solve(m_matrix, product, m_rhs, m_delta);
  if (is_first) m_first_residual = report.first;
  solver.set_goal(slack);
  // What the solution pulls at and the hand would feel moves, too: some layers of it in a blow, none as a
  // rule.
  constexpr int kMostLayers = 16;
  for (int i = 0; follows_force && i < kMostLayers && report.converged && grow_region_by_force(loads); ++i) {
    const linear::SolveReport first = report;
    report = solver.solve(m_matrix, product, m_rhs, m_delta);
    report.iterations += first.iterations;
  }
  const auto solve_anew = [&] {
    const int before = report.iterations;
    guess(true);
    report = solver.solve(m_matrix, product, m_rhs, m_delta);
    report.iterations += before;
    if (is_first) m_first_residual = report.first;
  };
  const bool is_number = report.iterations > 0 || !std::isnan(report.relative_residual);
  if (!report.converged && is_number && m_region && !m_is_static) {  // of the whole, where a factor may do
    leave_region(loads);
    solve_anew();
  }
  if (report.wants_stored) {
    store_nodal_stiffness();
    assemble_matrix(loads.contacts);
    solve_anew();
  }
  m_counters.linear_iterations += report.iterations;
  m_counters.has_solved |= report.iterations > 0 || linear::is_direct(m_params.solver.kind);
  m_counters.residual = report.relative_residual;
  m_counters.imbalance = report.relative_residual * report.first / m_tau;
  return report;
}

/// ‖b − A δ‖, which m_left becomes, of rows that are solved for: by present rotations where these are at
/// hand.
double Solid::find_left(Product& product) {
  if (may_lag_further())
    product.multiply_present(m_delta, m_left);
  else
    product.multiply(m_delta, m_left);
  return std::sqrt(m_rows.sum(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    auto left = m_left.middleCols(begin, end - begin);
    left = m_rhs.middleCols(begin, end - begin) - left;
    return left.squaredNorm();
  }));
}

/// What solve and frames have left. What frames leave goes with their lag and the body's speed; it is found,
/// by a pass over the tets, every few steps and where it may be more than `share` [of the right-hand side].
/// Frames lag the less the more that was, and slowly more again.
double Solid::estimate_left(Product& product, double share) {
  constexpr double kAim = 0.8;     // of the share
  constexpr double kMargin = 1.5;  // beside what is expected
  constexpr double kGrown = 2.0;
  constexpr int kStands = 8;
  constexpr double kMore = 2.0;  // times the lag of the last step
  const double of_solve = m_tau * m_counters.imbalance;
  if (!may_lag_further()) return of_solve;
  const double way =
      frame_tolerance() * std::sqrt(m_rows.sum(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        return m_delta.middleCols(begin, end - begin).squaredNorm();
      }));
  auto& known = m_frame_error;
  const double expected = kMargin * known.left * (known.way > 0.0 ? way / known.way : 1.0);
  if (known.steps > 0 && expected <= kMargin * share && way <= kGrown * known.way) {
    --known.steps;
    return std::hypot(of_solve, expected);
  }
  const double left = find_left(product);
  const double of_frames = std::sqrt(std::max(0.0, left * left - of_solve * of_solve));
  known = {of_frames, way, kStands};
  m_frame_slack = frame_tolerance() * (of_frames * kMore > kAim * share ? kAim * share / of_frames : kMore);
  return left;
}

/// Solves for what is left of the step, Newton's method on a matrix whose frames lag, until that is little. A
/// body that turns is strained where it is seen from a frame that lags, and its damping resists: that may be
/// far more than the lag times the residual. True when the solution is another.
bool Solid::correct_solution(const StepLoads& loads) {
  constexpr double kWorthwhile = 0.5;  // of what was left, for another round
  Product product(*this, loads.contacts);
  const double share = m_tau * loads.slack;
  double left = estimate_left(product, share);
  const double enough =
      std::min(2.0 * std::max(m_params.solver.tolerance * m_first_residual, share), m_tau * loads.limit);
  if (left > enough) left = find_left(product);
  m_solver->set_goal(0.5 * enough);
  bool has_changed = false;
  for (double before = std::numeric_limits<double>::infinity();
       left > enough && left < kWorthwhile * before;) {
    before = left;
    m_near_rows.each(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_correction.middleCols(begin, end - begin).setZero();
    });
    linear::SolveReport report = m_solver->solve(m_matrix, product, m_left, m_correction);
    if (report.wants_stored) {
      store_nodal_stiffness();
      assemble_matrix(loads.contacts);
      m_correction.setZero();
      report = m_solver->solve(m_matrix, product, m_left, m_correction);
    }
    m_counters.linear_iterations += report.iterations;
    if (!report.converged) break;
    m_rows.each(num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      m_delta.middleCols(begin, end - begin) += m_correction.middleCols(begin, end - begin);
    });
    has_changed = true;
    left = find_left(product);
  }
  m_counters.has_solved |= has_changed;
  m_counters.imbalance = left / m_tau;
  return has_changed;
}

void Solid::prepare_response(const SolidState& state, double step_s) {
  ARGIL_ASSERT(!is_explicit());
  store_nodal_stiffness();  // its solves are exact ones
  m_is_static = false;
  m_plastic_strain = &state.plastic_strain;
  m_tau = find_tau(state, step_s);
  m_is_projected = true;
  keep_damping_frame();
  update_volume_change(state.plastic_strain);
  assemble_matrix({});
}

StepStatus Solid::find_response(const Points& force, Tick tick, Points& displacement) {
  displacement = force;
  clear_held(displacement);
  if (!m_response_solver) m_response_solver = linear::make_solver(make_exact(m_params.solver), m_threads);
  for (int r = 0; r < num_free(); ++r)
    m_rhs.col(r) = m_tau * m_tau * displacement.col(m_node_of_row[static_cast<std::size_t>(r)]);
  displacement.setZero();
  if (m_rhs.isZero(0.0)) return StepStatus::ok();
  m_delta.setZero();
  Product product(*this, {});
  const linear::SolveReport report = m_response_solver->solve(m_matrix, product, m_rhs, m_delta);
  if (!report.converged)
    return StepStatus::failed({tick, "solid", -1, "relative residual of the compliance's solve",
                               report.relative_residual, make_exact(m_params.solver).tolerance});
  for (int r = 0; r < num_free(); ++r)
    displacement.col(m_node_of_row[static_cast<std::size_t>(r)]) = m_delta.col(r);
  clear_held(displacement);
  return StepStatus::ok();
}

Mat3 Solid::compute_local_response(int node) const {
  const int row = m_row_of_node[static_cast<std::size_t>(node)];
  if (row < 0) return Mat3::Zero();
  Mat3 response =
      m_tau * m_tau * Mat3(m_matrix.block(m_matrix.diagonal[static_cast<std::size_t>(row)])).inverse();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (m_constraints.support(axis, node) >= 0) response(axis, axis) = 0.0;
  return response;
}

void Solid::exchange_state(Archive& archive) {
  archive.number("solid/newton_iterations", m_counters.newton_iterations);
  archive.number("solid/linear_iterations", m_counters.linear_iterations);
  archive.number("solid/residual", m_counters.residual);
  bool stores_nodal = m_nodal && !m_nodal_product;
  archive.number("solid/stores_nodal", stores_nodal);
  if (stores_nodal) store_nodal_stiffness();
  m_solver->exchange_state(archive, "solver/", m_matrix);
  bool has_region = m_region != nullptr;
  archive.number("region/is_used", has_region);
  if (has_region && !m_region) make_region();
  if (!has_region && m_region) drop_region();
  bool has_response_solver = m_response_solver != nullptr;
  archive.number("response/is_known", has_response_solver);
  if (!has_response_solver) return;
  if (!m_response_solver) m_response_solver = linear::make_solver(make_exact(m_params.solver), m_threads);
  m_response_solver->exchange_state(archive, "response/", m_matrix);
}

void Solid::exchange_frames(Archive& archive) {
  if (m_region) {
    m_region->exchange_state(archive);
    if (archive.is_restoring()) visit_region();
    archive.number("region/fastest", m_fastest);
    archive.number("region/held_back", m_held_back);
    archive.any_size("region/last_load", m_last_load);
  }
  if (archive.is_restoring()) {
    m_has_old_nodes = m_has_old_forces = true;
    std::fill(m_is_tet_changed.begin(), m_is_tet_changed.end(), char{1});
    std::fill(m_is_batch_new.begin(), m_is_batch_new.end(), char{1});
  }
  archive.number("solid/frame_slack", m_frame_slack);
  archive.number("solid/frame_error", m_frame_error.left);
  archive.number("solid/frame_error_way", m_frame_error.way);
  archive.number("solid/frame_error_steps", m_frame_error.steps);
  if (has_lagging_frames()) m_kinematics.exchange_frames(archive);
}

bool Solid::has_lagging_frames() const {
  return m_kinematics.has_frames() && frame_tolerance() > 0.0;
}

StepStatus Solid::restore_kinematics(const Points& x, Tick tick) {
  return update_motion(x, tick, has_lagging_frames());
}

}  // namespace argil::solid
