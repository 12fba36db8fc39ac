#include "device/hand_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"

namespace argil::device {
namespace {

constexpr double kTremorDamping = 0.1;  // of critical: a band of ± 10 % about the resonance

/// e^A by its series: A is halved until it is short, and the result squared as often. No library function
/// whose last bit depends on the processor.
Eigen::Matrix2d exponential(Eigen::Matrix2d a) {
  int halvings = 0;
  for (; a.cwiseAbs().maxCoeff() > 0.25; ++halvings) a *= 0.5;
  Eigen::Matrix2d term = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d sum = term;
  for (int n = 1; n <= 14; ++n) {  // (2·0.25)¹⁵/15! is far below rounding
    term = (term * a / n).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = (sum * sum).eval();
  return sum;
}

/// Variance of x that independent inputs u of variance 1, one a step, sustain: the first entry of P in
/// P = Φ P Φᵀ + g gᵀ, g being what an input adds to (x, v).
double stationary_variance(const Oscillator& o) {
  const Eigen::Vector2d g(1.0 - o.xx, -o.vx);
  Mat3 m;
  m << o.xx * o.xx, 2.0 * o.xx * o.xv, o.xv * o.xv,         //
      o.xx * o.vx, o.xx * o.vv + o.xv * o.vx, o.xv * o.vv,  //
      o.vx * o.vx, 2.0 * o.vx * o.vv, o.vv * o.vv;
  return ((Mat3::Identity() - m).inverse() * Vec3(g[0] * g[0], g[0] * g[1], g[1] * g[1]))[0];
}

double hand_omega(const HandParams& p) {
  return std::sqrt(p.stiffness / p.mass);
}

}  // namespace

Oscillator::Oscillator(double omega, double zeta, double step) {
  // In (x, v/ω), whose entries are of one size.
  Eigen::Matrix2d a;
  a << 0.0, 1.0, -1.0, -2.0 * zeta;
  const Eigen::Matrix2d e = exponential(omega * step * a);
  xx = e(0, 0);
  xv = e(0, 1) / omega;
  vx = e(1, 0) * omega;
  vv = e(1, 1);
}

void Oscillator::advance(double u, double& x, double& v) const {
  const double stretch = x - u;
  x = u + xx * stretch + xv * v;
  v = vx * stretch + vv * v;
}

HandModel::HandModel(const HandParams& params, const Trace& intent, double period, double start)
    : m_params(params),
      m_intent(intent),
      m_period(period),
      m_start(start),
      m_hand(hand_omega(params), params.damping / (2.0 * params.mass * hand_omega(params)), period),
      m_tremor(2.0 * std::numbers::pi * params.tremor_frequency, kTremorDamping, period),
      m_tremor_drive(params.tremor * std::sqrt(3.0 / stationary_variance(m_tremor))),
      m_rng(static_cast<std::uint64_t>(params.seed), "tremor"),
      m_x(interpolate(intent, start).position) {
  ARGIL_ASSERT(params.mass > 0.0 && params.stiffness > 0.0 && params.damping >= 0.0, params.mass,
               params.stiffness, params.damping);
  ARGIL_ASSERT(params.reaction_delay >= 0.0 && params.tremor >= 0.0 && params.tremor_frequency > 0.0,
               params.reaction_delay, params.tremor, params.tremor_frequency);
  ARGIL_ASSERT(period > 0.0, period);
}

double HandModel::time() const {
  return static_cast<double>(m_tick) * m_period;
}

/// Where the muscles draw the hand now: before its delay is over, the start.
DeviceSample HandModel::intend() const {
  return interpolate(m_intent, m_start + std::max(0.0, time() - m_params.reaction_delay));
}

DeviceSample HandModel::advance(const Vec3& force) {
  ++m_tick;
  DeviceSample now = intend();
  for (int axis = 0; axis < 3; ++axis) {
    if (m_tremor_drive > 0.0)
      m_tremor.advance(m_rng.uniform(-m_tremor_drive, m_tremor_drive), m_shake[axis], m_shake_v[axis]);
    // A force that is held moves the spring's balance by F/k.
    const double balance = now.position[axis] + m_shake[axis] + force[axis] / m_params.stiffness;
    m_hand.advance(balance, m_x[axis], m_v[axis]);
  }
  now.position = m_x;
  return now;
}

void HandModel::serialize(Archive& archive) {
  archive.number("hand_model/tick", m_tick);
  archive.array("hand_model/x", m_x);
  archive.array("hand_model/v", m_v);
  archive.array("hand_model/shake", m_shake);
  archive.array("hand_model/shake_v", m_shake_v);
  if (!archive.is_restoring() || !(m_tremor_drive > 0.0)) return;
  m_rng = Rng(static_cast<std::uint64_t>(m_params.seed), "tremor");  // gives again what it gave
  for (Tick k = 0; k < 3 * m_tick; ++k) m_rng.next_bits();
}

DeviceSample HandModel::sample() const {
  DeviceSample now = intend();
  now.position = m_x;
  return now;
}

}  // namespace argil::device
