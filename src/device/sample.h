#pragma once

#include "base/types.h"

namespace argil::device {

/// What the tool does to the body while it touches.
enum class ToolMode : std::uint8_t {
  push,  ///< presses the body inward
  pull,  ///< draws the body outward: the contact force acts with its sign reversed
  wet,   ///< gives water; feels a force but does not deform the body
  dry,   ///< takes water; feels a force but does not deform the body
};

/// One reading of the haptic device, in world coordinates.
struct DeviceSample {
  Vec3 position = Vec3::Zero();        ///< hand's point [m]
  Quat orientation = Quat::Identity(); ///< unit quaternion, tool frame to world
  ToolMode mode = ToolMode::push;
};

}  // namespace argil::device
