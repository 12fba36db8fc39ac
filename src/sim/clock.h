#pragma once

#include "base/types.h"

namespace argil::sim {

/// Integer time. Tick k covers [kδ, (k+1)δ]; what has a period of p ticks is due at the end of every p-th.
struct Clock {
  Tick tick = 0;          ///< tick that is being computed
  double period = 0.001;  ///< δ [s]

  bool due(int period_ticks) const { return (tick + 1) % period_ticks == 0; }
  double time_at_end() const { return static_cast<double>(tick + 1) * period; }  ///< [s]
  double seconds(int ticks) const { return ticks * period; }
  void advance() { ++tick; }
};

/// Does some multiple of `period` ticks lie in (before, after]?
constexpr bool passes_multiple(Tick before, Tick after, int period) {
  return before / period != after / period;
}

}  // namespace argil::sim
