#pragma once

#include <omp.h>

#include <cstddef>

namespace argil {

namespace internal {
inline thread_local bool is_in_team = false;
}

/// Calls body() on each of `threads` threads at once. parallel_for and what is made of it, called by all of
/// them in it, then share their items among them and wait for one another at the end, which is cheaper than
/// to start anew each time. All else in `body` is done by each thread and may write only to what is its own.
template <class Body>
void in_team(int threads, Body body) {
  if (threads <= 1) {
    body();
    return;
  }
#pragma omp parallel num_threads(threads)
  {
    internal::is_in_team = true;
    body();
    internal::is_in_team = false;
  }
}

/// Is this the one of a team's threads that writes what all have found?
inline bool is_first_of_team() {
  return !internal::is_in_team || omp_get_thread_num() == 0;
}

/// Calls body(i) for i = 0 … count−1 on `threads` threads. Each call may write only what belongs to i;
/// sums over i are taken afterwards in index order, so results never depend on `threads`.
template <class Body>
void parallel_for(std::ptrdiff_t count, int threads, Body body) {
  if (internal::is_in_team) {
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
    return;
  }
  if (threads <= 1) {
    for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
}

}  // namespace argil
