#include "device/gate.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace argil::device {
namespace {

// Shortens v to `limit` when it is longer. The largest component is divided out first: the square of 1e300 is
// infinite. True when it was shortened.
bool clamp_norm(double limit, Vec3& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest == 0.0) return false;
  const Vec3 scaled = v / largest;  // norm in [1, √3]
  const double norm = scaled.norm();
  if (largest <= limit / norm) return false;
  v = (limit / norm) * scaled;
  return true;
}

bool zero_unless_finite(Vec3& v) {
  if (v.allFinite()) return false;
  v.setZero();
  return true;
}

void scale(double share, GateEvent event, GatedForce& out) {
  out.force *= share;
  out.torque *= share;
  out.events |= event;
}

}  // namespace

HandFeed judge_feed(const WatchdogLimits& limits, std::int64_t sample_number, double sample_age,
                    double physics_age) {
  if (sample_number <= 0) return HandFeed::none;
  const bool is_fresh = sample_age <= limits.max_sample_age && physics_age <= limits.max_physics_age;
  return is_fresh ? HandFeed::fresh : HandFeed::stale;
}

OutputGate::OutputGate(const DeviceLimits& limits, double period_s) : m_limits(limits), m_period(period_s) {
  const WatchdogLimits& watchdog = limits.watchdog;
  ARGIL_ASSERT(limits.max_force > 0.0 && limits.max_force_rate > 0.0, limits.max_force,
               limits.max_force_rate);
  ARGIL_ASSERT(limits.max_torque >= 0.0 && limits.ramp_s >= 0.0, limits.max_torque, limits.ramp_s);
  ARGIL_ASSERT(period_s > 0.0, period_s);
  ARGIL_ASSERT(watchdog.release_s >= 0.0 && watchdog.release_s <= 1e9 * period_s, watchdog.release_s);
  m_release_periods = std::max(Tick{1}, static_cast<Tick>(std::llround(watchdog.release_s / period_s)));
}

GatedForce OutputGate::apply(const Vec3& force, const Vec3& torque, HandFeed feed) {
  GatedForce out{force, torque, kGateNone};
  if (feed == HandFeed::none) {
    out = {Vec3::Zero(), Vec3::Zero(), kGateNoSample};
  } else {
    limit_norms(out);
    scale_by_ramp(out);
    scale_by_watchdog(feed, out);
    ++m_count;
  }
  limit_rate(out);
  return out;
}

/// Finite and within the norm limits.
void OutputGate::limit_norms(GatedForce& out) const {
  // Both calls must run, hence | and not ||, here and below.
  if (zero_unless_finite(out.force) | zero_unless_finite(out.torque)) out.events |= kGateNotFinite;

  const bool torque_clamped = m_limits.max_torque > 0.0 && clamp_norm(m_limits.max_torque, out.torque);
  if (clamp_norm(m_limits.max_force, out.force) | torque_clamped) out.events |= kGateClamped;
}

void OutputGate::scale_by_ramp(GatedForce& out) const {
  const double age = static_cast<double>(m_count) * m_period;
  if (age < m_limits.ramp_s) scale(age / m_limits.ramp_s, kGateRamp, out);
}

void OutputGate::scale_by_watchdog(HandFeed feed, GatedForce& out) {
  if (feed == HandFeed::stale)
    m_withdrawn = std::min(m_withdrawn + 1, m_release_periods);
  else
    m_withdrawn = std::max(m_withdrawn - 1, Tick{0});
  if (m_withdrawn == 0) return;
  scale(static_cast<double>(m_release_periods - m_withdrawn) / static_cast<double>(m_release_periods),
        kGateWatchdog, out);
}

/// No further from the last force than the slew limit allows. Acts last: a ramp that ends, or a hand that is
/// let go, would add its own rate.
void OutputGate::limit_rate(GatedForce& out) {
  Vec3 change = out.force - m_last_force;
  if (clamp_norm(m_limits.max_force_rate * m_period, change)) {
    out.force = m_last_force + change;
    out.events |= kGateSlew;
  }
  clamp_norm(m_limits.max_force, out.force);  // the sum above may round past the limit by an ulp
  m_last_force = out.force;
}

void OutputGate::restore(Tick count, const Vec3& last_force, Tick withdrawn) {
  m_count = count;
  m_last_force = last_force;
  m_withdrawn = withdrawn;
}

}  // namespace argil::device
