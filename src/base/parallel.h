#pragma once

#include <cstddef>

#include "base/thread_team.h"

namespace argil {

/// Calls body(i) for i = 0 … count−1 on `threads` threads. Each call may write only what belongs to i;
/// sums over i are taken afterwards in index order, so results never depend on `threads`.
template <class Body>
void parallel_for(std::ptrdiff_t count, int threads, Body body) {
  if (threads <= 1) {
    for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
    return;
  }
  ThreadTeam& team = ThreadTeam::of_this_thread(threads);
  const std::ptrdiff_t num_chunks = team.num_chunks();
  auto run_chunk = [&](std::ptrdiff_t chunk) {
    const std::ptrdiff_t end = count * (chunk + 1) / num_chunks;
    for (std::ptrdiff_t i = count * chunk / num_chunks; i < end; ++i) body(i);
  };
  team.run(run_chunk);
}

}  // namespace argil
