#pragma once

#include "base/types.h"

namespace argil::sim {

/// Integer time. Tick k, from 1, covers [(k−1)δ, kδ]; what has a period of p ticks is due at the end of every
/// p-th.
struct Clock {
  Tick tick = 0;          ///< ticks made; the one under way has the number tick + 1
  double period = 0.001;  ///< δ [s]

  /// At the end of the tick under way?
  bool due(int period_ticks) const { return (tick + 1) % period_ticks == 0; }
  double seconds(int ticks) const { return ticks * period; }
  void advance() { ++tick; }
};

/// Does some multiple of `period` ticks lie in (before, after]?
constexpr bool passes_multiple(Tick before, Tick after, int period) {
  return before / period != after / period;
}

}  // namespace argil::sim
