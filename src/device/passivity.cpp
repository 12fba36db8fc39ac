#include "device/passivity.h"

#include <algorithm>

namespace argil::device {

double compute_work(const Wrench& wrench, const TickMotion& motion) {
  return wrench.force.dot(motion.path) + wrench.torque.dot(motion.turn);
}

Wrench damp_generated_energy(const Wrench& wrench, const TickMotion& motion, double observed) {
  // Force and torque are damped in proportion to what each generates. To take twice its work turns a vector
  // about in the direction of the motion and keeps its length: no more than that.
  const double by_force = std::max(0.0, wrench.force.dot(motion.path));
  const double by_torque = std::max(0.0, wrench.torque.dot(motion.turn));
  const double generated = by_force + by_torque;
  const double excess = compute_work(wrench, motion) - observed;
  if (!(generated > 0.0 && excess > 0.0)) return wrench;
  const double share = std::min(2.0, excess / generated);
  Wrench damped = wrench;
  if (by_force > 0.0) damped.force -= share * by_force / motion.path.squaredNorm() * motion.path;
  if (by_torque > 0.0) damped.torque -= share * by_torque / motion.turn.squaredNorm() * motion.turn;
  return damped;
}

}  // namespace argil::device
