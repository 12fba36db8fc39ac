#pragma once

#include <chrono>

#include "base/types.h"

namespace argil::run {

/// A line on standard error that shows how far a run is, its rate and the time left; only on a terminal.
class Progress {
 public:
  Progress(Tick num_ticks, bool enabled);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Redraws at most five times a second.
  void update(Tick tick);

 private:
  void draw(Tick tick, double elapsed);

  Tick m_num_ticks;
  bool m_enabled;
  std::chrono::steady_clock::time_point m_start;
  double m_last_drawn = -1.0;
};

}  // namespace argil::run
