#pragma once

#include "solid/product.h"

namespace argil::solid {

/// How far the frames of the matrix may lag behind R: a step that is solved to a tolerance may as well have a
/// matrix that is off by as much. Its residual is always that of R.
double find_frame_tolerance(const Body& body);

/// Do frames lag in steps of this body?
bool has_lagging_frames(const Body& body);

/// May they lag more than that where a step has slack? Only where what it leaves is known all the same.
bool may_lag_further(const Body& body);

/// Takes the memory for what it takes to know that.
void make_room_for_lag(Body& body);

/// Solves for what is left of the step, Newton's method on a matrix whose frames lag, until that is little. A
/// body that turns is strained where it is seen from a frame that lags, and its damping resists: that may be
/// far more than the lag times the residual. True when the solution is another.
bool correct_solution(Body& body, const Part& part, const StepLoads& loads);

}  // namespace argil::solid
