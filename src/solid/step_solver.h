#pragma once

#include "base/status.h"
#include "solid/active_region.h"

namespace argil::solid {

/// When a step is made.
struct StepTime {
  double length = 0.0;  ///< [s]
  double end = 0.0;     ///< [s]
  Tick tick = 0;
};

/// F → R → ε at positions x of what may have moved; frames lag as far as the next solve lets them. Fails when
/// det F is not above the bound of the parameters.
StepStatus update_kinematics(Body& body, const ActiveRegion& region, const Points& x, Tick tick);

/// x̂, v̂ and τ of a step from `state`; prescribed nodes go to where they are at its end. Kinematics must be
/// those of state.x.
StepStatus begin_step(Body& body, ActiveRegion& region, const SolidState& state, const StepLoads& loads,
                      const StepTime& time);

/// Residual and matrix of a step at the present iterate, of the part of the body that moves. True when
/// Newton's residual is small enough.
bool assemble(Body& body, ActiveRegion& region, const StepLoads& loads);

/// After the first assembly of a step: the norm over all awake nodes of the forces [N] that would act on them
/// if the body were stopped where it is, and of those that stop it within the step.
double compute_imbalance(const Body& body, const ActiveRegion& region, const StepLoads& loads);

/// One linear solve as exact as the loads ask for and, for Newton's method, its line search. Sets `solved`
/// when no other is wanted.
StepStatus solve(Body& body, ActiveRegion& region, const StepLoads& loads, Tick tick, bool& solved);

}  // namespace argil::solid
