#pragma once

#include <optional>

#include "device/hand_model.h"
#include "scenario/scenario.h"
#include "sim/simulation.h"

namespace argil::run {

/// Where the tool goes, tick by tick: along the trace, or with a simulated hand that means to.
class HandMotion {
 public:
  /// Of an empty trace nothing is asked.
  HandMotion(const scenario::Scenario& s, const device::Trace& trace);
  /// The hand at the end of tick k, one after the last call's; `felt`: what the device renders meanwhile [N],
  /// after passivity and gate.
  device::DeviceSample advance(Tick k, const Vec3& felt);
  /// Adds to a checkpoint what advance takes from earlier calls, or takes it back.
  void serialize(Archive& archive);

 private:
  const scenario::Scenario& m_scenario;
  const device::Trace& m_trace;
  std::optional<device::HandModel> m_hand;
};

}  // namespace argil::run
