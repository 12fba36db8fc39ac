#pragma once

#include "base/status.h"
#include "linear/solver.h"
#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// What Newton's method, statics and compliances ask of a solve: there its error does not go with the next
/// step, or another iteration costs more than what a loose solve saves.
linear::SolverParams make_exact(linear::SolverParams solver);

/// First guess of δ: the body goes on as before the step (`is_anew`), else δ as it is; Newton's is 0.
void guess(Body& body, const Part& part, bool is_anew);

/// Norm of the residual that a step's solves may leave.
double find_enough(const Body& body);

/// Books what a solve took and left in the step's counters.
void count_solve(Body& body, const linear::SolveReport& report);

/// v = v_base + share · δ, x = x̂ + τ v.
void set_iterate(Body& body, const Part& part, double share);

/// Explicit: δ = r / m, and the iterate.
void solve_explicit(Body& body, const Part& part);

/// Halves Newton's step until the potential falls by a share of what its slope promises [Armijo1966]. Where
/// the promise is below rounding, the full step is taken.
StepStatus search_line(Body& body, const Part& part, const StepLoads& loads, Tick tick);

/// Why a linear solve failed.
StepStatus describe_failure(const linear::SolveReport& report, double tolerance, Tick tick);

}  // namespace argil::solid
