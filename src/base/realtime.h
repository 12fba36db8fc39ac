#pragma once

#include <pthread.h>

namespace argil {

/// Locks the process's memory, present and future, so that no tick waits for a page. False when not
/// permitted.
bool lock_memory();

/// Of threads that run before all ordinary ones: above what other programs ask for, below the kernel's own.
inline constexpr int kHandPriority = 80;
inline constexpr int kDevicePriority = kHandPriority - 1;

/// Lets a thread run before all ordinary ones (SCHED_FIFO); those that it starts are ordinary again. False
/// when not permitted.
bool make_realtime(pthread_t thread, int priority);

/// Lets the calling thread wake when it asked to: the system may otherwise add 50 µs where it is an ordinary
/// one.
void wake_without_slack();

/// Seconds of the monotonic clock. Allowed in a signal handler.
double monotonic_now() noexcept;

/// Sleeps until the monotonic clock shows `time` [s].
void sleep_until(double time);

/// Between two looks at what another thread does, 1 ms; a signal ends it early. Allowed in a signal handler.
void pause_1_ms() noexcept;

}  // namespace argil
