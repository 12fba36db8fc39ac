#pragma once

#include "base/status.h"
#include "solid/part.h"
#include "solid/predict.h"

namespace argil::solid {

struct Body;

/// How the frames of the matrix follow the rotations.
struct FrameUpdate {
  double tolerance = 0.0;     ///< on ‖R − Q‖, beyond which Q becomes R
  bool keeps_frames = false;  ///< Q stays as it is
};

/// F → R → ε of the tets of `part` at positions x. Fails when det F is not above the bound of the parameters.
StepStatus update_kinematics(Body& body, const Part& part, const Points& x, const FrameUpdate& frames,
                             Tick tick);

/// v ← v' of the nodes of `part`.
void take_velocity(const Body& body, const Part& part, SolidState& state);
/// x ← x̂ + τ v; prescribed components go where they must.
void move(const Body& body, const Part& part, SolidState& state);

/// Of a step that is made, what bdf2 must remember.
void keep_start(const Body& body, SolidState& state);

}  // namespace argil::solid
