#pragma once

#include "base/types.h"

namespace argil::device {

/// What the device may be asked to render.
struct DeviceLimits {
  double max_force = 3.3;          ///< [N]; norm is clamped
  double max_torque = 0.0;         ///< [N m]; 0: the device renders no torque limit, none is applied
  double max_force_rate = 1000.0;  ///< [N/s]; slew limit
  double ramp_s = 0.0;             ///< start-up ramp from zero [s]
};

/// What the gate did to one force; bits that add.
enum GateEvent : std::uint8_t {
  kGateNone = 0,
  kGateNotFinite = 1,
  kGateClamped = 2,
  kGateSlew = 4,
  kGateRamp = 8
};

struct GatedForce {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]
  std::uint8_t events = kGateNone;
};

/// Last station before the hand: not-finite to zero, norm clamp, start-up ramp, slew limit, in that order.
/// The simulation's own force is not changed by it; both are recorded. Whatever comes in, what goes out is
/// finite, no longer than max_force, and no further than max_force_rate · period from the force before (zero
/// at first). Torque has no slew limit. Limits: max_force, max_force_rate > 0, the others ≥ 0, period > 0.
class OutputGate {
 public:
  OutputGate(const DeviceLimits& limits, double period_s);
  GatedForce apply(const Vec3& force, const Vec3& torque);

  /// Periods since the start and the last force: all that a snapshot needs to go on to the same bits.
  Tick count() const { return m_count; }
  const Vec3& last_force() const { return m_last_force; }
  void restore(Tick count, const Vec3& last_force);

 private:
  DeviceLimits m_limits;
  double m_period;
  Tick m_count = 0;
  Vec3 m_last_force = Vec3::Zero();
};

}  // namespace argil::device
