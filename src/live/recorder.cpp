#include "live/recorder.h"

#include <algorithm>

#include "base/realtime.h"

namespace argil::live {

/// A quick body may answer before the hand has given away the tick.
void Recorder::drain(Session& session) {
  for (;;) {
    if (!m_has_step) m_has_step = session.pop(m_step);
    for (HandTick tick; session.pop(tick);) write(tick);
    if (!m_has_step || m_steps_written == m_steps_begun) return;
    write(m_step);
    m_has_step = false;
  }
}

/// The record last: its flush takes the other rows of the tick along.
void Recorder::write(const HandTick& tick) {
  m_steps_begun = std::max(m_steps_begun, tick.session.begun_step);
  m_figures.add(tick);
  m_file.append(tick.session);
  m_file.append(tick.timing);
  m_file.append(tick.record);
  if (m_watch) m_watch->append(tick);
}

void Recorder::write(const BodyStep& step) {
  ++m_steps_written;
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
