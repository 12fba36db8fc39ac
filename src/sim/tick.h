#pragma once

#include "base/status.h"
#include "device/gate.h"
#include "device/sample.h"

namespace argil::sim {

class HandSide;
struct ContactLoad;

/// What a tick of the hand shares with the steps of the body.
struct TickPlan {
  bool receives_step = false;  ///< at its begin, the result of the step under way
  bool begins_step = false;    ///< at its end, with what the hand has gathered
  device::HandFeed feed = device::HandFeed::fresh;
  /// The tick begins a step and waits for its result. Batch does so always, live never.
  bool waits_for_result = false;
};

/// Who makes the steps of the body: the tick itself, or a thread beside the hand's.
class BodySteps {
 public:
  virtual ~BodySteps() = default;
  /// A step starts with what the hand has gathered. In batch and replay the whole step is made here and now,
  /// and the body commits or rolls back. Live, the load is only handed to the physics thread.
  virtual void start_step(HandSide& hand) = 0;
  /// The hand receives the result of the last step, or its failure.
  virtual StepStatus receive_step(HandSide& hand) = 0;
};

/// Stages of a tick, in their order (step.cpp).
StepStatus make_tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample,
                     const TickPlan& plan);
/// One haptic tick, in batch, live and replay alike. One that fails leaves the hand as it was before. `load`:
/// where a tick that waits for a result fails, the load that it handed over is taken back from here; null in
/// ticks that do not wait.
StepStatus tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample, const TickPlan& plan,
                ContactLoad* load = nullptr);

}  // namespace argil::sim
