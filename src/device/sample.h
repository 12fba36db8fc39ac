#pragma once

#include <optional>
#include <string_view>

#include "base/types.h"

namespace argil::device {

/// What the tool does to the body while it touches.
enum class ToolMode : std::uint8_t {
  push,  ///< presses the body inward
  pull,  ///< draws the body outward: the contact force acts with its sign reversed
  wet,   ///< gives water; feels a force but does not deform the body
  dry,   ///< takes water; feels a force but does not deform the body
};

inline constexpr int kNumToolModes = 4;

/// "push", "pull", "wet" or "dry".
constexpr std::string_view to_string(ToolMode mode) {
  constexpr std::string_view kNames[kNumToolModes] = {"push", "pull", "wet", "dry"};
  return kNames[static_cast<std::size_t>(mode)];
}

/// The mode of that name; nothing for any other text.
constexpr std::optional<ToolMode> find_tool_mode(std::string_view name) {
  for (int i = 0; i < kNumToolModes; ++i)
    if (name == to_string(static_cast<ToolMode>(i))) return static_cast<ToolMode>(i);
  return std::nullopt;
}

/// One reading of the haptic device, in world coordinates.
struct DeviceSample {
  Vec3 position = Vec3::Zero();         ///< hand's point [m]
  Quat orientation = Quat::Identity();  ///< unit quaternion, tool frame to world
  ToolMode mode = ToolMode::push;
};

/// Force and torque on the hand about its point.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]
};

/// x_world = rotation · (scale · x_device) + translation; forces turn with `rotation`, and
/// q_world = rotation · q_device · tool_rotation.
struct DeviceToWorld {
  double scale = 1.0;
  Quat rotation = Quat::Identity();
  Vec3 translation = Vec3::Zero();  ///< [m]
  Quat tool_rotation =
      Quat::Identity();  ///< the scene's tool to the device's, whose tip looks along another axis
};

}  // namespace argil::device
