#pragma once

#include "base/status.h"
#include "linear/solver.h"
#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// Residual, potential and matrix at the present iterate. True when the residual is small enough.
bool assemble_newton(Body& body, const Part& part, const StepLoads& loads);

/// One iteration: A δ = r by `solver`, and its line search.
StepStatus solve_newton(Body& body, const Part& part, const StepLoads& loads, linear::Solver& solver,
                        Tick tick);

}  // namespace argil::solid
