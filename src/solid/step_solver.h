#pragma once

#include "base/status.h"
#include "solid/active_region.h"

namespace argil::solid {

/// Residual and matrix of a step at the present iterate, of the part of the body that moves. True when
/// Newton's residual is small enough.
bool assemble(Body& body, ActiveRegion& region, const StepLoads& loads);

/// One linear solve as exact as the loads ask for and, for Newton's method, its line search. Sets `solved`
/// when no other is wanted.
StepStatus solve(Body& body, ActiveRegion& region, const StepLoads& loads, Tick tick, bool& solved);

}  // namespace argil::solid
