#pragma once

#include <cstdint>

#include "base/archive.h"
#include "base/rng.h"
#include "device/trace.h"

namespace argil::device {

/// A hand as a mass on a spring and a damper, each axis for itself. The intent pulls the spring's other end.
struct HandParams {
  double mass = 0.15;             ///< m [kg], > 0: finger and stylus
  double damping = 6.0;           ///< c [N s/m], ≥ 0
  double stiffness = 300.0;       ///< k [N/m], > 0
  double reaction_delay = 0.0;    ///< [s], ≥ 0: the intent reaches the muscle so much later
  double tremor = 0.0;            ///< root mean square of the intended point's tremor, each axis [m]
  double tremor_frequency = 9.0;  ///< its resonance [Hz], > 0
  int seed = 1;                   ///< of the tremor
};

/// A body on a spring and a damper, ẍ = ω² (u − x) − 2ζω ẋ, over one step with u held: exact.
struct Oscillator {
  Oscillator(double omega, double zeta, double step);
  /// One component of position and velocity over one step.
  void advance(double u, double& x, double& v) const;
  double xx, xv, vx, vv;  ///< what (x − u, v) become
};

/// m ẍ = k (x_intent(t − delay) + tremor − x) − c ẋ + F   [Hogan1985: a hand's motion as that of a spring's
/// equilibrium point]. Orientation and mode are the intent's, so much later; torque does not turn the hand.
/// The same sequence of forces gives the same bits.
class HandModel {
 public:
  /// `intent` is copied; the hand starts at rest where it is `start` seconds after its beginning.
  HandModel(const HandParams& params, const Trace& intent, double period, double start = 0.0);
  /// Over one period, which ends at the time of the sample that comes back, under a force that was held [N].
  DeviceSample advance(const Vec3& force);
  DeviceSample sample() const;  ///< now
  double time() const;          ///< since the start [s]
  /// All that advance takes from earlier calls.
  void serialize(Archive& archive);

 private:
  DeviceSample intend() const;

  HandParams m_params;
  Trace m_intent;
  double m_period;
  double m_start;  ///< of the intent's time [s]
  Oscillator m_hand;
  Oscillator m_tremor;
  double m_tremor_drive;  ///< half width of the tremor's uniform input [m]
  Rng m_rng;
  Tick m_tick = 0;
  Vec3 m_x = Vec3::Zero();        ///< [m]
  Vec3 m_v = Vec3::Zero();        ///< [m/s]
  Vec3 m_shake = Vec3::Zero();    ///< tremor of the intended point [m]
  Vec3 m_shake_v = Vec3::Zero();  ///< [m/s]
};

}  // namespace argil::device
