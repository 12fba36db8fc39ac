// x̂, v̂ and τ of a step, and where its supports go.

#include "solid/predict.h"

#include "solid/body.h"

namespace argil::solid {

double compute_tau(Integrator integrator, double step_s) {
  switch (integrator) {
    case Integrator::bdf2:
      return 2.0 / 3.0 * step_s;
    case Integrator::newmark:
      return 0.5 * step_s;
    case Integrator::backward_euler:
    case Integrator::symplectic_euler:
      break;
  }
  return step_s;
}

void keep_damping_frame(Body& body) {
  if (body.is_newton() && body.model.params.rayleigh_stiffness > 0.0)
    body.prediction.kept_rotation = body.kinematics.rotation();
  else
    body.prediction.kept_rotation.resize(3, 0);
}

namespace {

/// Average acceleration: v' = v + ½h(a + a'), x' = x + ½h(v + v'). Contacts act as at the end, whatever acts
/// at the start: of those that fall, nothing falls here.
void predict_newmark(Body& body, const Part& part, const StepLoads& loads) {
  const SolidState& start = body.committed;
  Prediction& step = body.prediction;
  body.trial.v = start.v;
  step.v_hat = start.v;
  StepLoads without_contacts = loads;
  without_contacts.contacts = {};
  assemble_residual(body, part, without_contacts);  // τ (f_ext − f_int − D v) at the start
  for (int row = 0; row < body.model.num_free(); ++row) {
    const int node = body.model.node_of_row[static_cast<std::size_t>(row)];
    step.v_hat.col(node) = start.v.col(node) + body.system.rhs.col(row) / body.materials.mass()(node);
  }
  step.x_hat = start.x + step.tau * start.v;
}

/// x̂, v̂ of each integrator; at first those of the committed state, which Euler's keep.
void set_prediction(Body& body, const Part& part, const StepLoads& loads) {
  const SolidState& start = body.committed;
  Prediction& step = body.prediction;
  start_from_committed(body, part);
  switch (body.model.params.integrator) {
    case Integrator::backward_euler:
    case Integrator::symplectic_euler:
      return;
    case Integrator::bdf2:
      if (start.x_before.size() == 0) return;
      step.x_hat = (4.0 * start.x - start.x_before) / 3.0;
      step.v_hat = (4.0 * start.v - start.v_before) / 3.0;
      return;
    case Integrator::newmark:
      predict_newmark(body, part, loads);
  }
}

}  // namespace

void start_from_committed(Body& body, const Part& part) {
  const SolidState& start = body.committed;
  Prediction& step = body.prediction;
  part.nodes.each(start.x.cols(), [&](std::ptrdiff_t n) {
    step.x_hat.col(n) = body.trial.x.col(n) = start.x.col(n);
    step.v_hat.col(n) = body.trial.v.col(n) = start.v.col(n);
  });
}

bool place_supports(Body& body, double time, double share) {
  const Model& model = body.model;
  Prediction& step = body.prediction;
  bool has_moved = false;
  step.is_shifted = false;
  for (const auto& [n, k] : model.placed_components) {
    const auto support = static_cast<std::size_t>(model.constraints.support(k, n));
    step.held_x(k, n) =
        model.elements.rest(k, n) + share * compute_displacement(model.supports[support], time)(k);
    has_moved = has_moved || body.trial.x(k, n) != step.held_x(k, n);
    step.is_shifted = step.is_shifted || step.held_x(k, n) != model.elements.rest(k, n);
    body.trial.x(k, n) = step.held_x(k, n);
  }
  return has_moved;
}

bool predict(Body& body, const Part& part, const StepLoads& loads, double step_s, double time) {
  const SolidState& start = body.committed;
  SolidState& trial = body.trial;
  Prediction& step = body.prediction;
  step.is_static = false;
  step.load_share = 1.0;
  body.history.counters = {};
  body.newton.iterations = 0;
  body.newton.is_follow_up = body.newton.has_moved = false;
  body.newton.tolerance = body.model.params.newton_tolerance;
  body.contacts.start(loads.contacts, start.v, step_s);
  keep_damping_frame(body);
  // The first step of bdf2 has no past and is backward Euler's.
  const bool has_past = body.model.params.integrator != Integrator::bdf2 || start.x_before.size() > 0;
  step.tau = has_past ? compute_tau(body.model.params.integrator, step_s) : step_s;
  set_prediction(body, part, loads);
  const bool has_moved = place_supports(body, time, 1.0);
  if (!body.is_explicit())
    part.nodes.each(trial.v.cols(), [&](std::ptrdiff_t n) {
      trial.v.col(n) = (trial.x.col(n) - step.x_hat.col(n)) / step.tau;
    });
  // Held components go at their mean velocity; Newmark's own rule would let it swing about that.
  for (const auto& [n, k] : body.model.placed_components)
    trial.v(k, n) = (step.held_x(k, n) - start.x(k, n)) / step_s;
  if (body.is_explicit()) trial.x = start.x;  // forces are those of the start
  return has_moved && !body.is_explicit();
}

}  // namespace argil::solid
