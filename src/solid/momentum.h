#pragma once

#include <span>

#include "solid/part.h"
#include "solid/step_loads.h"

namespace argil::solid {

struct Body;

/// After an iterative solve: adds to δ the speed of the whole body, along each axis along which nothing holds
/// it, at which its rows leave no force in all. What an iteration leaves would drive a free body on, step
/// after step. `part`: the whole body.
void balance_momentum(Body& body, const Part& part, std::span<const PointStiffness> contacts);

}  // namespace argil::solid
