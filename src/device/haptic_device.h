#pragma once

#include <string>

#include "device/sample.h"

namespace argil::device {

/// What a device says of itself; final once it is ready. A zero is "not stated".
struct DeviceInfo {
  std::string kind;               ///< as the factory knows it: "simulated", "haply", …
  std::string name;               ///< as the device calls itself
  double max_force = 0.0;         ///< [N]; 0 with has_force: not stated
  double max_torque = 0.0;        ///< [N m]
  double max_stiffness = 0.0;     ///< largest stiffness it renders stably [N/m]
  Vec3 workspace = Vec3::Zero();  ///< edges of the box that its point reaches, device axes [m]
  double rate_hz = 0.0;           ///< samples a second
  bool has_force = false;         ///< it renders forces; otherwise they are dropped
};

enum class DeviceState : std::uint8_t {
  stopped,     ///< before start and after stop
  connecting,  ///< started, no valid sample yet
  ready,       ///< the last sample is younger than the limit
  stale,       ///< no valid sample for longer than the limit; becomes ready again with the next
  lost,        ///< gone for good: HapticDevice::problem() says why; only stop and start bring it back
};

/// "stopped", "connecting", "ready", "stale" or "lost".
constexpr std::string_view to_string(DeviceState state) {
  constexpr std::string_view kNames[] = {"stopped", "connecting", "ready", "stale", "lost"};
  return kNames[static_cast<std::size_t>(state)];
}

/// What one look at the device gives the hand's thread.
struct DevicePoll {
  DeviceSample sample;      ///< last valid one, world coordinates; meaningless before the first
  std::int64_t number = 0;  ///< of that sample among the valid ones, from 1; 0: none has come yet
  double time = 0.0;  ///< when it came [s], on the device's clock: steady_clock, virtual time if simulated
  double age = 0.0;   ///< now less `time` [s]
  DeviceState state = DeviceState::stopped;
  bool is_valid() const { return number > 0; }
};

/// Messages since start.
struct DeviceCounts {
  std::int64_t samples = 0;   ///< valid samples
  std::int64_t repeated = 0;  ///< came again or out of order, not used
  std::int64_t refused = 0;   ///< could not be read, or held no usable sample
};

/// A device with a hand at it. One thread, the hand's, calls poll and send once a tick each: neither waits,
/// locks, allocates or throws. The others may be called from any other thread, one at a time.
class HapticDevice {
 public:
  HapticDevice() = default;
  HapticDevice(const HapticDevice&) = delete;
  HapticDevice& operator=(const HapticDevice&) = delete;
  virtual ~HapticDevice() = default;  ///< stops

  /// Begins to look for the device; a failure shows as DeviceState::lost.
  virtual void start() = 0;
  /// Sends zero force and lets the device go. Not while the hand's thread polls or sends.
  virtual void stop() noexcept = 0;

  virtual DevicePoll poll() noexcept = 0;
  /// The force and torque that the hand is to feel from now on, world coordinates. The device turns them into
  /// its own axes; it does not scale them.
  virtual void send(const Wrench& on_hand) noexcept = 0;
  /// Zero force as fast as it goes, and none after it until start: from any thread or a signal handler, also
  /// when the process is in ruins. See release_guard.h.
  virtual void release() noexcept = 0;

  virtual DeviceState state() const noexcept = 0;
  virtual DeviceInfo info() const = 0;
  virtual DeviceCounts counts() const = 0;
  /// Why the device is lost, with place and remedy; empty when it is not.
  virtual std::string problem() const = 0;
};

}  // namespace argil::device
