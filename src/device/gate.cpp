#include "device/gate.h"

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

}  // namespace

OutputGate::OutputGate(const DeviceLimits& limits, double period_s) : m_limits(limits), m_period(period_s) {
  ARGIL_ASSERT(limits.max_force > 0.0 && limits.max_force_rate > 0.0, limits.max_force,
               limits.max_force_rate);
  ARGIL_ASSERT(limits.max_torque >= 0.0 && limits.ramp_s >= 0.0, limits.max_torque, limits.ramp_s);
  ARGIL_ASSERT(period_s > 0.0, period_s);
}

GatedForce OutputGate::apply(const Vec3& force, const Vec3& torque) {
  GatedForce out{force, torque, kGateNone};
  // Both calls must run, hence | and not ||, here and below.
  if (zero_unless_finite(out.force) | zero_unless_finite(out.torque)) out.events |= kGateNotFinite;

  const bool torque_clamped = m_limits.max_torque > 0.0 && clamp_norm(m_limits.max_torque, out.torque);
  if (clamp_norm(m_limits.max_force, out.force) | torque_clamped) out.events |= kGateClamped;

  const double age = static_cast<double>(m_count) * m_period;
  if (age < m_limits.ramp_s) {
    out.force *= age / m_limits.ramp_s;
    out.torque *= age / m_limits.ramp_s;
    out.events |= kGateRamp;
  }

  Vec3 change = out.force - m_last_force;
  if (clamp_norm(m_limits.max_force_rate * m_period, change)) {
    out.force = m_last_force + change;
    out.events |= kGateSlew;
  }
  clamp_norm(m_limits.max_force, out.force);  // the sum above may round past the limit by an ulp

  m_last_force = out.force;
  ++m_count;
  return out;
}

void OutputGate::restore(Tick count, const Vec3& last_force) {
  m_count = count;
  m_last_force = last_force;
}

}  // namespace argil::device
