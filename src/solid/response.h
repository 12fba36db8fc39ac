#pragma once

#include "base/status.h"
#include "solid/part.h"
#include "solid/state.h"

namespace argil::solid {

struct Body;

/// Of find_response, where there is none yet.
void make_response_solver(Body& body);

/// Makes the matrix of a step of step_s seconds from the present kinematics, without contacts. It serves the
/// functions below until the next step begins.
void prepare_response(Body& body, const Part& part, const SolidState& state, double step_s);

/// How far forces (3×n) [N] move every node by the end of such a step: τ² A⁻¹ f [m].
StepStatus find_response(Body& body, const Part& part, const Points& force, Tick tick, Points& displacement);

/// The same of one node by a force on it while all others stay: τ² Aᵢᵢ⁻¹ [m/N], a lower bound.
Mat3 compute_local_response(const Body& body, int node);

}  // namespace argil::solid
