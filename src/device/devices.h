#pragma once

#include <memory>
#include <string>
#include <vector>

#include "device/hand_model.h"
#include "device/haptic_device.h"
#include "device/trace.h"

namespace argil::device {

/// How a device is attached. Each kind uses what concerns it.
struct DeviceOptions {
  DeviceToWorld device_to_world;   ///< of positions and orientations; forces only turn (not for simulated)
  ToolMode mode = ToolMode::push;  ///< until a button changes it
  double period = 0.001;           ///< of the hand's ticks [s]: one poll moves a simulated hand on by it
  double stale_after = 0.02;       ///< age of a sample [s] at which the device counts as stale
  Trace intent;                    ///< simulated: where the hand means to be; world coordinates
  HandParams hand;                 ///< simulated
};

struct DeviceKind {
  std::string name;   ///< as make_device takes it
  std::string about;  ///< one line
};

/// The kinds that this program was built with.
std::vector<DeviceKind> device_kinds();

/// A device, not started, by the name of its kind and, after a colon, where it is: "simulated",
/// "haply:HOST:PORT". Throws InputError for any other name, for a simulated hand without an intent and for
/// options out of range.
std::unique_ptr<HapticDevice> make_device(const std::string& name, const DeviceOptions& options);

/// A line for each name of what the device there is: state, name and limits, or why it is not there. Each is
/// given so many seconds to answer. Throws InputError as make_device does.
std::string describe_devices(const std::vector<std::string>& names, double patience);

/// Waits until the device is ready or lost, or for so many seconds; what it is then.
DeviceState wait_until_ready(const HapticDevice& device, double timeout);

}  // namespace argil::device
