// Passivity controller: what it takes off, and that energy at the port stays its own [Hannaford2002].
#include "device/passivity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"

namespace argil::device {
namespace {

TEST(Passivity, LeavesAForceThatResistsOrGivesBackWhatItGot) {
  const Wrench push{{0.0, 0.0, 2.0}, {0.0, 0.1, 0.0}};
  const TickMotion against{{0.0, 0.0, -1e-3}, Vec3::Zero()};
  EXPECT_EQ(damp_generated_energy(push, against, 0.0).force, push.force);
  const TickMotion with{{0.0, 0.0, 1e-3}, Vec3::Zero()};  // 2 mJ to the hand
  EXPECT_EQ(damp_generated_energy(push, with, 2.1e-3).force, push.force);
  EXPECT_EQ(damp_generated_energy(push, with, 2.1e-3).torque, push.torque);
}

TEST(Passivity, DampsAlongTheMotionToWhatTheObserverHolds) {
  // F·Δx = 2 mJ with 0.5 mJ in the observer: F' = F − b v with F'·Δx = 0.5 mJ; across the motion F stays.
  const Wrench push{{1.0, 0.0, 2.0}, Vec3::Zero()};
  const TickMotion with{{0.0, 0.0, 1e-3}, Vec3::Zero()};
  EXPECT_TRUE(damp_generated_energy(push, with, 0.5e-3).force.isApprox(Vec3(1.0, 0.0, 0.5), 1e-15));
  // Below zero it is filled up, by no more than the force turned about.
  EXPECT_TRUE(damp_generated_energy(push, with, -0.5e-3).force.isApprox(Vec3(1.0, 0.0, -0.5), 1e-15));
  EXPECT_TRUE(damp_generated_energy(push, with, -9.0).force.isApprox(Vec3(1.0, 0.0, -2.0), 1e-15));
}

TEST(Passivity, SharesBetweenForceAndTorque) {
  // 1 mJ by the force and 3 mJ by the torque, none in the observer: both lose all that generates.
  const Wrench wrench{{0.0, 1.0, 0.0}, {3.0, 0.0, 5.0}};
  const TickMotion motion{{0.0, 1e-3, 0.0}, {1e-3, 0.0, 0.0}};
  const Wrench damped = damp_generated_energy(wrench, motion, 0.0);
  EXPECT_NEAR(compute_work(damped, motion), 0.0, 1e-18);
  EXPECT_TRUE(damped.torque.isApprox(Vec3(0.0, 0.0, 5.0), 1e-15));
}

TEST(Passivity, NeverLengthensWhateverComes) {
  Rng rng(7, "passivity");
  const auto draw = [&rng](double size) {
    return Vec3(size * rng.uniform(-1, 1), size * rng.uniform(-1, 1), size * rng.uniform(-1, 1));
  };
  for (int i = 0; i < 10000; ++i) {
    const Wrench wrench{draw(3.0), draw(0.1)};
    const TickMotion motion{draw(std::pow(10.0, rng.uniform(-12, -2))), draw(0.01)};
    const double observed = rng.uniform(-1e-3, 1e-3);
    const Wrench damped = damp_generated_energy(wrench, motion, observed);
    ASSERT_LE(damped.force.norm(), wrench.force.norm() * (1.0 + 1e-12));
    ASSERT_LE(damped.torque.norm(), wrench.torque.norm() * (1.0 + 1e-12));
    // After another such tick the observer is not below zero, unless it was and the force could not do more.
    if (observed >= 0.0) {
      ASSERT_GE(observed - compute_work(damped, motion), -1e-15);
    }
  }
}

}  // namespace
}  // namespace argil::device
