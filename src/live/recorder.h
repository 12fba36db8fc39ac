#pragma once

#include "live/figures.h"
#include "live/session.h"
#include "live/watch.h"
#include "output/result_file.h"

namespace argil::live {

/// Takes from a running session what it gives away and writes it, in the thread of the caller.
class Recorder {
 public:
  /// `watch` may be null. All are kept by reference.
  Recorder(output::ResultFile& file, Figures& figures, Watch* watch)
      : m_file(file), m_figures(figures), m_watch(watch) {}

  /// All that came since the last call, each step after the tick that began it. Throws IoError.
  void drain(Session& session);

 private:
  void write(const HandTick& tick);
  void write(const BodyStep& step);

  output::ResultFile& m_file;
  Figures& m_figures;
  Watch* m_watch;
  BodyStep m_step;  // that waits for the tick that began it
  bool m_has_step = false;
  Tick m_steps_begun = 0, m_steps_written = 0;
};

}  // namespace argil::live
