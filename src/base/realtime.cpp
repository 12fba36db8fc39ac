#include "base/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <ctime>

namespace argil {

bool lock_memory() {
  // What has been allocated once stays with the process, so that a later growth finds its pages there.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  // Under a limit, what is allocated later could be refused and end the program: only what is there now then.
  rlimit limit = {};
  const bool is_limited =
      geteuid() != 0 && (getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY);
  return mlockall(is_limited ? MCL_CURRENT : MCL_CURRENT | MCL_FUTURE) == 0;
}

void wake_without_slack() {
  prctl(PR_SET_TIMERSLACK, 1UL);  // [ns]
}

bool make_realtime(pthread_t thread, int priority) {
  sched_param parameters = {};
  parameters.sched_priority = priority;
  return pthread_setschedparam(thread, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0;
}

double monotonic_now() noexcept {
  timespec now = {};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void sleep_until(double time) {
  timespec wanted = {};
  const double seconds = std::floor(time);
  wanted.tv_sec = static_cast<time_t>(seconds);
  wanted.tv_nsec = static_cast<long>(1e9 * (time - seconds));
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wanted, nullptr) == EINTR) {
  }
}

void pause_1_ms() noexcept {
  constexpr timespec kPause = {0, 1000000};
  nanosleep(&kPause, nullptr);
}

}  // namespace argil
