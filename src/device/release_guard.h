#pragma once

#include "device/haptic_device.h"

namespace argil::device {

/// While it lives, the device is released when the process crashes (SIGSEGV, SIGBUS, SIGFPE, SIGILL,
/// SIGABRT), is told to end by a signal that nothing else handles (SIGINT, SIGTERM, SIGHUP), or calls exit.
/// The signal then goes on as it would have. One guard at a time; kill -9 leaves it to the device, which goes
/// limp when its commands cease.
class ReleaseGuard {
 public:
  explicit ReleaseGuard(HapticDevice& device);
  ~ReleaseGuard();
  ReleaseGuard(const ReleaseGuard&) = delete;
  ReleaseGuard& operator=(const ReleaseGuard&) = delete;
};

}  // namespace argil::device
