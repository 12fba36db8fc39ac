#pragma once

#include <vector>

#include "base/types.h"
#include "contact/pressure.h"
#include "device/gate.h"
#include "sim/pressed_patch.h"
#include "sim/state.h"

namespace argil::sim {

/// What a step of the body tells the hand.
struct StepResult {
  Tick step = 0;           ///< number of the step, from 1
  bool has_moved = false;  ///< the body has; else its surface is where it was
  bool is_held = false;    ///< it could not be computed: the body stood still, the hand keeps its last force
  bool is_whole = true;    ///< all of its surface may have moved; else only these vertices have:
  std::vector<int> moved;
  Points surface_x;  ///< places of all vertices of the touched surface, or of these [m], where it has moved
  device::Wrench felt;  ///< what the hand felt, less what the body's deflection has taken from it

  ForceErrorRates error;  ///< of that force

  bool is_limited = false;  ///< motion was held back: `felt` is that of the step that was solved for

  Vec3 friction = Vec3::Zero();  ///< [N] part of that force: of a pressure's friction
  PressedPatch pressed;          ///< where it acts, of a pressure; found where the hand carries it on

  std::vector<contact::StiffnessOfTriangle> stiffness;  ///< where the water has changed it: pressure law

  /// Takes storage for a touched surface of `num_vertices`.
  explicit StepResult(Eigen::Index num_vertices) : surface_x(3, num_vertices) {
    moved.reserve(static_cast<std::size_t>(num_vertices));
    stiffness.reserve(2 * moved.capacity());
  }
};

}  // namespace argil::sim
