#pragma once

#include "base/status.h"
#include "solid/part.h"
#include "solid/state.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

enum class EquilibriumAccuracy {
  exact,       ///< as /dynamics/newton/tolerance asks
  rough,       ///< to 1e-5 of loads and reactions, by iterations that need no factor
  rough_again  ///< the same with the matrix of the last time, from which the body has hardly moved
};

/// Static equilibrium of the whole body under `loads` from state.x on: the limit of a step without mass, by
/// Newton's method, to `accuracy`. Loads and prescribed displacements are applied in shares where they do not
/// converge at once; state.x then holds the last share that did. All of the body is to be awake.
StepStatus find_equilibrium(Body& body, const Part& whole, const StepLoads& loads, SolidState& state,
                            EquilibriumAccuracy accuracy = EquilibriumAccuracy::exact);

}  // namespace argil::solid
