#include "device/release_guard.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "base/check.h"
#include "base/realtime.h"

namespace argil::device {
namespace {

constexpr int kNumSignals = NSIG;

/// Those that do nothing by default or cannot be handled. All others end or stop a process.
constexpr std::array kLeftAlone = {SIGCHLD, SIGCONT, SIGURG, SIGWINCH, SIGKILL, SIGSTOP};

// A signal handler finds its device nowhere else.
std::atomic<HapticDevice*> s_device = nullptr;
std::atomic<bool> s_is_released = true;
std::array<struct sigaction, kNumSignals> s_before;

/// Once. A second thread that crashes meanwhile waits, for it would end the process too early.
void release_now() {
  HapticDevice* const device = s_device.exchange(nullptr);
  if (device != nullptr) {
    device->release();
    s_is_released = true;
    return;
  }
  for (int look = 0; look < 100 && !s_is_released; ++look) pause_1_ms();
}

void on_signal(int number) {
  const int error = errno;
  release_now();
  std::signal(number, SIG_DFL);
  std::raise(number);  // comes when this returns
  errno = error;
}

bool is_default(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_DFL;
}

using Handler = void (*)(int);
Handler find_handler(int number) {
  return number == SIGPIPE ? SIG_IGN : on_signal;
}

template <class Do>
void for_each_signal(Do act) {
  for (int number = 1; number < kNumSignals; ++number)
    if (std::find(kLeftAlone.begin(), kLeftAlone.end(), number) == kLeftAlone.end()) act(number);
}

}  // namespace

ReleaseGuard::ReleaseGuard(HapticDevice& device) {
  static const int registered = std::atexit(release_now);
  ARGIL_ASSERT(registered == 0 && s_device == nullptr);
  s_is_released = false;
  s_device = &device;
  for_each_signal([](int number) {
    struct sigaction& before = s_before[static_cast<std::size_t>(number)];
    // The C library keeps some numbers to itself: sigaction refuses them.
    if (sigaction(number, nullptr, &before) != 0 || !is_default(before)) return;
    struct sigaction action {};
    action.sa_handler = find_handler(number);
    action.sa_flags = SA_ONSTACK;
    sigfillset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  });
}

ReleaseGuard::~ReleaseGuard() {
  s_device = nullptr;
  s_is_released = true;
  for_each_signal([](int number) {
    const struct sigaction& before = s_before[static_cast<std::size_t>(number)];
    struct sigaction now;
    if (sigaction(number, nullptr, &now) == 0 && is_default(before) && (now.sa_flags & SA_SIGINFO) == 0 &&
        now.sa_handler == find_handler(number))
      sigaction(number, &before, nullptr);
  });
}

}  // namespace argil::device
