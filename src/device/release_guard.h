#pragma once

#include "base/signal_stack.h"
#include "device/haptic_device.h"

namespace argil::device {

/// While it lives, the device is released when the process crashes, also by a stack that overflows in a
/// thread with a SignalStack (this one has it), when a signal ends or stops it that nothing else handles, or
/// when it calls exit. The signal then goes on as it would have; SIGPIPE is ignored. One guard at a time,
/// destroyed by the thread that made it. SIGKILL and SIGSTOP leave it to the device, which goes limp when its
/// commands cease, if it does.
class ReleaseGuard {
 public:
  explicit ReleaseGuard(HapticDevice& device);
  ~ReleaseGuard();
  ReleaseGuard(const ReleaseGuard&) = delete;
  ReleaseGuard& operator=(const ReleaseGuard&) = delete;

 private:
  SignalStack m_stack;
};

}  // namespace argil::device
