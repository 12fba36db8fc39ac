#pragma once

#include "base/mandel.h"
#include "base/types.h"

namespace argil::solid {

/// Motion and history of the body; what a checkpoint must hold.
struct SolidState {
  Points x;                    ///< 3×n positions of the nodes [m]
  Points v;                    ///< 3×n velocities [m/s]
  TensorField plastic_strain;  ///< 6×p ε_p at each point in its turned frame, Mandel
  Points x_before, v_before;   ///< a step earlier, bdf2 only; empty before the first step
};

}  // namespace argil::solid
