#include "device/release_guard.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>

#include "base/check.h"

namespace argil::device {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGHUP};

// A signal handler finds its device nowhere else.
std::atomic<HapticDevice*> s_device = nullptr;
std::array<struct sigaction, kSignals.size()> s_before;

void release_now() {
  HapticDevice* const device = s_device.exchange(nullptr);
  if (device != nullptr) device->release();
}

void on_signal(int number) {
  release_now();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

bool is_ours(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == on_signal;
}

}  // namespace

ReleaseGuard::ReleaseGuard(HapticDevice& device) {
  static const int registered = std::atexit(release_now);
  ARGIL_ASSERT(registered == 0 && s_device == nullptr);
  s_device = &device;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &s_before[i]);
    if ((s_before[i].sa_flags & SA_SIGINFO) != 0 || s_before[i].sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigaction(kSignals[i], &action, nullptr);
  }
}

ReleaseGuard::~ReleaseGuard() {
  s_device = nullptr;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction now;
    sigaction(kSignals[i], nullptr, &now);
    if (is_ours(now)) sigaction(kSignals[i], &s_before[i], nullptr);
  }
}

}  // namespace argil::device
