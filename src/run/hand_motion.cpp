#include "run/hand_motion.h"

#include "run/loop.h"

namespace argil::run {

HandMotion::HandMotion(const scenario::Scenario& s, const device::Trace& trace)
    : m_scenario(s), m_trace(trace) {
  if (s.hand.kind == scenario::HandKind::simulated && !trace.samples.empty())
    m_hand.emplace(s.hand.params, trace, s.params.rates.haptic_period, s.trace.start);
}

device::DeviceSample HandMotion::advance(Tick k, const Vec3& felt) {
  if (!m_hand) return sample_at(m_scenario, m_trace, k);
  device::DeviceSample sample = m_hand->advance(felt);
  sample.mode = find_fixed_mode(m_scenario).value_or(sample.mode);
  return sample;
}

void HandMotion::serialize(Archive& archive) {
  if (m_hand) m_hand->serialize(archive);
}

}  // namespace argil::run
