#pragma once

#include "solid/part.h"
#include "solid/state.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// What a step begins with: every implicit integrator is
///   x' = x̂ + τ v',  M (v' − v̂) = τ (f_ext − f_int(x') − D v')
/// with its own x̂, v̂ and τ. Statics: without M and D, τ = 1, v' the displacement.
struct Prediction {
  bool is_static = false;
  bool is_rough = false;           ///< statics: by the stiffness of steps, gathered once
  bool keeps_matrix = false;       ///< statics: there is one that will do
  double load_share = 1.0;         ///< statics: part of the loads that is applied
  double tau = 0.0;                ///< [s]
  Points x_hat, v_hat;             ///< 3×n [m], [m/s]
  Points held_x;                   ///< 3×n [m]: where prescribed components are at the step's end
  bool is_shifted = false;         ///< some support is not where it was at rest
  Eigen::Matrix3Xd kept_rotation;  ///< damping's R of each point where it is not the present one; or empty
};

/// x̂, v̂ and τ of a step of step_s seconds from the committed state that ends at `time` [s], and the first
/// iterate. True when a support moved: kinematics are then to be those of the iterate.
bool predict(Body& body, const Part& part, const StepLoads& loads, double step_s, double time);

/// x̂, v̂ and the iterate of the nodes of `part` are those of the committed state.
void start_from_committed(Body& body, const Part& part);

/// Puts the prescribed components of the iterate where they are at `time`, the way there times `share`. True
/// when any of them moved.
bool place_supports(Body& body, double time, double share);

/// Newton's method damps in the frame of the step's start, so that a step has a potential.
void keep_damping_frame(Body& body);

}  // namespace argil::solid
