#pragma once

#include "device/sample.h"

namespace argil::device {

/// What keeps the force at the hand from generating energy.
enum class Passivity {
  none,
  time_domain,  ///< observer and adaptive damping [Hannaford2002]
};

/// Motion of the hand during one tick.
struct TickMotion {
  Vec3 path = Vec3::Zero();  ///< [m]
  Vec3 turn = Vec3::Zero();  ///< axis times angle [rad]
};

/// ∫ F·v + T·ω dt of a wrench that is held during the tick [J].
double compute_work(const Wrench& wrench, const TickMotion& motion);

/// Passivity controller in impedance causality. `observed`: energy [J] that the hand has given since the
/// start, less what it got back. Where `wrench`, held over another tick like the last, would give back more
/// than that, it is damped along the motion until it gives back just so much; an observer below zero, for the
/// hand moved on otherwise, is filled up again. The force that comes out is never longer than the one that
/// went in, nor is the torque.
Wrench damp_generated_energy(const Wrench& wrench, const TickMotion& motion, double observed);

}  // namespace argil::device
