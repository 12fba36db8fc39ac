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
  bool waits_for_step = false;  ///< that it begins: in batch a step takes no time
};

/// Who makes the steps of the body: the tick itself, or a thread beside the hand's.
class BodySteps {
 public:
  virtual ~BodySteps() = default;
  /// A step begins with what the hand has gathered.
  virtual void begin(HandSide& hand) = 0;
  /// The hand receives the result of the last one, or its failure.
  virtual StepStatus deliver(HandSide& hand) = 0;
};

/// Stages of a tick, in their order (step.cpp).
StepStatus make_tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample,
                     const TickPlan& plan);
/// One haptic tick, in batch, live and replay alike. One that fails leaves the hand as it was before;
/// `load`: the load that it has handed over to a step for which it waits, null where it waits for none.
StepStatus tick(HandSide& hand, BodySteps& steps, const device::DeviceSample& sample, const TickPlan& plan,
                ContactLoad* load = nullptr);

}  // namespace argil::sim
