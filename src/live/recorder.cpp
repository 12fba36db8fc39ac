#include "live/recorder.h"

namespace argil::live {

/// Ticks go before the step that they led to, which may have come after they were looked for.
void Recorder::drain(Session& session) {
  BodyStep step;
  bool has_step = false;
  do {
    has_step = session.pop(step);
    for (HandTick tick; session.pop(tick);) write(tick);
    if (has_step) write(step);
  } while (has_step);
}

/// The record last: its flush takes the other rows of the tick along.
void Recorder::write(const HandTick& tick) {
  m_figures.add(tick);
  m_file.append(tick.session);
  m_file.append(tick.timing);
  m_file.append(tick.record);
  if (m_watch) m_watch->append(tick);
}

void Recorder::write(const BodyStep& step) {
  m_figures.add(step);
  m_file.append(step.timing);
  m_file.append(step.record);
  if (!step.frame) return;
  if (m_watch) {
    m_watch->append(*step.frame);
    m_figures.add_picture(monotonic_now() - step.given_at);
  }
  m_file.append(*step.frame);
}

}  // namespace argil::live
