#pragma once

#include <thread>

namespace argil::live {

/// Locks the process's memory, present and future, so that no tick waits for a page. False when not
/// permitted.
bool lock_memory();

/// Lets a thread run before all ordinary ones (SCHED_FIFO). False when not permitted.
bool make_realtime(std::thread& thread);

/// Lets the calling thread wake when it asked to: the system may otherwise add 50 µs where it is an ordinary
/// one.
void wake_without_slack();

/// Sleeps until the monotonic clock shows `time` [s].
void sleep_until(double time);

}  // namespace argil::live
