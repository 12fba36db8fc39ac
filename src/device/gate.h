#pragma once

#include "base/types.h"

namespace argil::device {

/// When the hand is let go because what feeds it has stopped.
struct WatchdogLimits {
  double max_sample_age = 0.02;   ///< of the device's last valid sample [s]
  double max_physics_age = 0.25;  ///< of the surface that the force was found with [s]
  double release_s = 0.05;        ///< in which the force falls to zero, and comes back, where the slew limit
                                  ///< allows it [s]; 0: at once
};

/// What the device may be asked to render.
struct DeviceLimits {
  double max_force = 3.3;          ///< [N]; norm is clamped
  double max_torque = 0.0;         ///< [N m]; 0: the device renders no torque limit, none is applied
  double max_force_rate = 1000.0;  ///< [N/s]; slew limit
  double ramp_s = 0.0;             ///< start-up ramp from zero [s]
  WatchdogLimits watchdog;
};

/// What a tick's force rests on. A recorded motion is always fresh.
enum class HandFeed : std::uint8_t {
  fresh,
  stale,  ///< samples or physics are older than the limit: the hand is let go
  none,   ///< no valid sample has come yet: nothing is sent, the start-up ramp waits
};

/// `sample_number`: 0 before the first valid sample. Ages [s]; what is no number is too old.
HandFeed judge_feed(const WatchdogLimits& limits, std::int64_t sample_number, double sample_age,
                    double physics_age);

/// What the gate did to one force; bits that add.
enum GateEvent : std::uint8_t {
  kGateNone = 0,
  kGateNotFinite = 1,
  kGateClamped = 2,
  kGateSlew = 4,
  kGateRamp = 8,
  kGateWatchdog = 16,  ///< on the way to zero, there, or on the way back
  kGateNoSample = 32
};

struct GatedForce {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]
  std::uint8_t events = kGateNone;
};

/// Last station before the hand: not-finite to zero, norm clamp, start-up ramp, watchdog, slew limit, in that
/// order. The simulation's own force is not changed by it; both are recorded. Whatever comes in, what goes
/// out is finite, no longer than max_force, and no further from the force before (zero at first) than
/// max_force_rate · period, within rounding. Torque has no slew limit. Limits: max_force, max_force_rate > 0,
/// the others ≥ 0, period > 0.
class OutputGate {
 public:
  OutputGate(const DeviceLimits& limits, double period_s);
  GatedForce apply(const Vec3& force, const Vec3& torque, HandFeed feed = HandFeed::fresh);

  /// All that a snapshot needs to go on to the same bits: periods since the start, the last force that
  /// went out, and how many periods the watchdog is on its way to zero.
  Tick count() const { return m_count; }
  const Vec3& last_force() const { return m_last_force; }
  Tick withdrawn() const { return m_withdrawn; }
  void restore(Tick count, const Vec3& last_force, Tick withdrawn);

 private:
  void limit_norms(GatedForce& out) const;
  void scale_by_ramp(GatedForce& out) const;
  void scale_by_watchdog(HandFeed feed, GatedForce& out);
  void limit_rate(GatedForce& out);
  DeviceLimits m_limits;
  double m_period;
  Tick m_release_periods;  ///< until the watchdog is at zero, ≥ 1
  Tick m_count = 0;
  Vec3 m_last_force = Vec3::Zero();
  Tick m_withdrawn = 0;
};

}  // namespace argil::device
