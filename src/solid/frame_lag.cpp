#include "solid/frame_lag.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid/body.h"
#include "solid/matrix.h"
#include "solid/solve.h"

namespace argil::solid {
namespace {

/// ‖b − A δ‖, which scratch.left becomes, of the rows of the part: by present rotations where these are at
/// hand.
double find_left(Body& body, const Part& part, Product& product) {
  if (may_lag_further(body))
    product.multiply_present(body.system.delta, body.scratch.left);
  else
    product.multiply(body.system.delta, body.scratch.left);
  return std::sqrt(part.rows.sum(body.model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    auto left = body.scratch.left.middleCols(begin, end - begin);
    left = body.system.rhs.middleCols(begin, end - begin) - left;
    return left.squaredNorm();
  }));
}

/// What solve and frames have left. What frames leave goes with their lag and the body's speed; it is found,
/// by a pass over the tets, every few steps and where it may be more than `share` [of the right-hand side].
/// Frames lag the less the more that was, and slowly more again.
double estimate_left(Body& body, const Part& part, Product& product, double share) {
  constexpr double kAim = 0.8;     // of the share
  constexpr double kMargin = 1.5;  // beside what is expected
  constexpr double kGrown = 2.0;
  constexpr int kStands = 8;
  constexpr double kMore = 2.0;  // times the lag of the last step
  const double of_solve = body.prediction.tau * body.history.counters.imbalance;
  if (!may_lag_further(body)) return of_solve;
  const Points& delta = body.system.delta;
  const auto squares = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return delta.middleCols(begin, end - begin).squaredNorm();
  };
  const double lag_speed =
      find_frame_tolerance(body) * std::sqrt(part.rows.sum(body.model.num_free(), squares));
  FrameLag& known = body.history.frame_lag;
  const double expected = kMargin * known.left * (known.lag_speed > 0.0 ? lag_speed / known.lag_speed : 1.0);
  if (known.steps > 0 && expected <= kMargin * share && lag_speed <= kGrown * known.lag_speed) {
    --known.steps;
    return std::hypot(of_solve, expected);
  }
  const double left = find_left(body, part, product);
  const double of_frames = std::sqrt(std::max(0.0, left * left - of_solve * of_solve));
  const double more = of_frames * kMore > kAim * share ? kAim * share / of_frames : kMore;
  known = {find_frame_tolerance(body) * more, of_frames, lag_speed, kStands};
  return left;
}

/// One more solve, for scratch.left.
linear::SolveReport solve_for_left(Body& body, const Part& part, const StepLoads& loads, Product& product) {
  System& system = body.system;
  Points& correction = body.scratch.correction;
  part.near_rows.each(body.model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    correction.middleCols(begin, end - begin).setZero();
  });
  const linear::SolveReport report =
      body.history.solver->solve(system.matrix, product, body.scratch.left, correction);
  if (!report.wants_stored) return report;
  store_nodal_stiffness(body.model, body.materials, system);
  assemble_matrix(body, part, loads.contacts);
  correction.setZero();
  return body.history.solver->solve(system.matrix, product, body.scratch.left, correction);
}

}  // namespace

double find_frame_tolerance(const Body& body) {
  constexpr double kLargest = 0.01;
  if (body.prediction.is_static || !has_lagging_frames(body.model)) return 0.0;
  // A deformation that lags leaves a share of what the step adds, a rotation one of all that damping holds.
  constexpr double kOfDeformation = 10.0;
  const double tolerance = body.model.params.solver.tolerance;
  if (body.model.has_deformed_frames()) return std::min(kLargest, kOfDeformation * tolerance);
  return std::min(kLargest, std::max(tolerance, body.history.frame_lag.slack));
}

bool has_lagging_frames(const Model& model) {
  const SolidParams& params = model.params;
  return params.iteration != Iteration::newton && !linear::is_direct(params.solver.kind) &&
         params.solver.tolerance > 0.0;
}

bool may_lag_further(const Body& body) {
  return has_isotropic_tets(body.model, body.materials) && find_law(body.model.params.model).is_quadratic &&
         find_frame_tolerance(body) > 0.0;
}

void make_room_for_lag(Body& body) {
  const Eigen::Index num_tets = body.model.elements.num_tets();
  body.scratch.direction.resize(3, body.model.elements.num_nodes());
  body.scratch.change.strain.resize(6, num_tets);
  body.scratch.change.corner_force.resize(3, body.forces.corner.cols());
  if (!body.materials.nodal()) return;
  body.scratch.change.volume.resize(num_tets);
  body.scratch.change.pressure.resize(num_tets);
}

bool correct_solution(Body& body, const Part& part, const StepLoads& loads) {
  constexpr double kWorthwhile = 0.5;  // of what was left, for another round
  const double tau = body.prediction.tau;
  Product product(body, part, loads.contacts);
  const double share = tau * loads.slack;
  double left = estimate_left(body, part, product, share);
  const double enough = std::min(2.0 * std::max(find_enough(body), share), tau * loads.limit);
  if (left > enough) left = find_left(body, part, product);
  body.history.solver->set_goal(0.5 * enough);
  bool has_changed = false;
  for (double before = std::numeric_limits<double>::infinity();
       left > enough && left < kWorthwhile * before;) {
    before = left;
    const linear::SolveReport report = solve_for_left(body, part, loads, product);
    body.history.counters.linear_iterations += report.iterations;
    if (!report.converged) break;
    part.rows.each(body.model.num_free(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      body.system.delta.middleCols(begin, end - begin) +=
          body.scratch.correction.middleCols(begin, end - begin);
    });
    has_changed = true;
    left = find_left(body, part, product);
  }
  body.history.counters.has_solved |= has_changed;
  body.history.counters.imbalance = left / tau;
  return has_changed;
}

}  // namespace argil::solid
