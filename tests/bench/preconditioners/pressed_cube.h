#pragma once

#include "linear/block_matrix.h"

namespace argil::bench {

/// A x = b of a body's step: x is by how much its free nodes change their speed beyond that of a body that
/// goes on as before, rows along Hilbert's curve.
struct StepSystem {
  int num_tets = 0;
  linear::BlockMatrix before;  ///< A of 40 steps earlier
  linear::BlockMatrix matrix;
  Points rest;  ///< where the rows' nodes are at rest [m]
  Points b;
  double off = 0.0;  ///< ‖x − what the solid's own step did‖ / ‖x‖, with x to 1e-10
};

/// An elastic cube of 6 cm on its fixed bottom, E = 140 kPa, ν = 0.3, 1500 kg/m³, corotational, h = 1 ms,
/// pressed for 60 steps by a force on a spot of its top that grows to 6 N.
StepSystem make_pressed_cube(int target_tets);

}  // namespace argil::bench
