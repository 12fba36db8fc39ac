#pragma once

#include <cstddef>

namespace argil {

/// Calls body(i) for i = 0 … count−1 on `threads` threads. Each call may write only what belongs to i;
/// sums over i are taken afterwards in index order, so results never depend on `threads`.
template <class Body>
void parallel_for(std::ptrdiff_t count, int threads, Body body) {
  if (threads <= 1) {
    for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::ptrdiff_t i = 0; i < count; ++i) body(i);
}

}  // namespace argil
