#include "solid/move.h"

#include <cmath>

#include "solid/body.h"

namespace argil::solid {

StepStatus update_kinematics(Body& body, const Part& part, const Points& x, const FrameUpdate& frames,
                             Tick tick) {
  const SolidParams& params = body.model.params;
  Kinematics& kinematics = body.kinematics;
  kinematics.update(body.model.elements, body.materials.gradient(), x,
                    {part.batches, frames.keeps_frames, frames.tolerance, body.system.is_tet_changed,
                     body.energies.is_batch_new});
  body.elastic.forget(part.batches);
  const double least = kinematics.min_volume_ratio();
  // Strain of the linear model has no inside to turn out; in statics its solution is what was asked for.
  const bool may_invert = body.prediction.is_static && find_law(params.model).is_linear;
  if (std::isfinite(least) && (may_invert || least > params.min_volume_ratio)) return StepStatus::ok();
  const int worst = kinematics.find_worst_point();
  return StepStatus::failed({tick, "solid", body.model.elements.number_of_point(worst),
                             "volume ratio det F of a tet", kinematics.volume_ratio(worst),
                             params.min_volume_ratio});
}

void take_velocity(const Body& body, const Part& part, SolidState& state) {
  part.nodes.each(state.v.cols(), [&](std::ptrdiff_t n) { state.v.col(n) = body.trial.v.col(n); });
}

void move(const Body& body, const Part& part, SolidState& state) {
  const Prediction& step = body.prediction;
  part.nodes.each(state.x.cols(),
                  [&](std::ptrdiff_t n) { state.x.col(n) = step.x_hat.col(n) + step.tau * state.v.col(n); });
  for (const auto& [n, k] : body.model.placed_components) state.x(k, n) = step.held_x(k, n);
}

void keep_start(const Body& body, SolidState& state) {
  if (body.model.params.integrator != Integrator::bdf2) return;
  state.x_before = body.committed.x;
  state.v_before = body.committed.v;
}

}  // namespace argil::solid
