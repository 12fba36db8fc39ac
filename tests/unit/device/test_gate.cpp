// The output gate: whatever comes in, what goes out is finite, within the force limit and within the slew
// limit. Expected values by hand from the limits.
#include "device/gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/rng.h"

namespace argil::device {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kPeriod = 0.001;
// A rate at which one period allows more than any change within the force limit.
constexpr double kNoSlew = 1e9;

DeviceLimits limits(double max_force, double rate, double ramp = 0.0, double max_torque = 0.0) {
  DeviceLimits l;
  l.max_force = max_force;
  l.max_force_rate = rate;
  l.ramp_s = ramp;
  l.max_torque = max_torque;
  return l;
}

TEST(OutputGate, LetsASmallForceThroughUnchangedAndWithoutAnEvent) {
  OutputGate gate(limits(3.3, kNoSlew), kPeriod);
  const GatedForce out = gate.apply(Vec3(0.1, -0.2, 0.3), Vec3(0.01, 0.0, 0.0));
  EXPECT_EQ(out.force, Vec3(0.1, -0.2, 0.3));
  EXPECT_EQ(out.torque, Vec3(0.01, 0.0, 0.0));
  EXPECT_EQ(out.events, kGateNone);
}

TEST(OutputGate, TurnsAnyNotFiniteForceIntoZeroAndSaysSo) {
  for (const Vec3& bad : {Vec3(kNaN, 1, 1), Vec3(1, kInf, 1), Vec3(1, 1, -kInf), Vec3(kNaN, kNaN, kInf)}) {
    OutputGate gate(limits(3.3, kNoSlew), kPeriod);
    const GatedForce out = gate.apply(bad, Vec3::Zero());
    EXPECT_EQ(out.force, Vec3::Zero());
    EXPECT_EQ(out.events, kGateNotFinite);
  }
}

TEST(OutputGate, TurnsANotFiniteTorqueIntoZeroAndKeepsTheForce) {
  OutputGate gate(limits(3.3, kNoSlew), kPeriod);
  const GatedForce out = gate.apply(Vec3(1, 0, 0), Vec3(0, kNaN, 0));
  EXPECT_EQ(out.force, Vec3(1, 0, 0));
  EXPECT_EQ(out.torque, Vec3::Zero());
  EXPECT_EQ(out.events, kGateNotFinite);
}

TEST(OutputGate, ClampsTheNormAndKeepsTheDirection) {
  OutputGate gate(limits(2.5, kNoSlew), kPeriod);
  const GatedForce out = gate.apply(Vec3(30, 0, -40), Vec3::Zero());  // norm 50
  EXPECT_NEAR(out.force.x(), 1.5, 1e-15);
  EXPECT_NEAR(out.force.z(), -2.0, 1e-15);
  EXPECT_EQ(out.events, kGateClamped);
}

TEST(OutputGate, ClampsForcesWhoseSquareOverflows) {
  for (const double huge : {1e200, 1e300, 1.7e308}) {
    OutputGate gate(limits(3.0, kNoSlew), kPeriod);
    const GatedForce out = gate.apply(Vec3(huge, -huge, huge), Vec3::Zero());
    EXPECT_NEAR(out.force.x(), std::sqrt(3.0), 1e-15);
    EXPECT_NEAR(out.force.y(), -std::sqrt(3.0), 1e-15);
    EXPECT_EQ(out.events, kGateClamped);
  }
}

TEST(OutputGate, RampsLinearlyFromZero) {
  OutputGate gate(limits(3.3, kNoSlew, 4 * kPeriod), kPeriod);
  for (int tick = 0; tick < 6; ++tick) {
    const GatedForce out = gate.apply(Vec3(2, 0, 0), Vec3(0, 1, 0));
    const double share = std::min(1.0, tick / 4.0);
    EXPECT_NEAR(out.force.x(), 2.0 * share, 1e-15);
    EXPECT_NEAR(out.torque.y(), share, 1e-15);
    EXPECT_EQ(out.events, tick < 4 ? kGateRamp : kGateNone);
  }
}

TEST(OutputGate, LimitsTheRateOfASuddenReversal) {
  OutputGate gate(limits(3.0, 500.0), kPeriod);  // 0.5 N a period
  for (int tick = 1; tick <= 6; ++tick)
    EXPECT_NEAR(gate.apply(Vec3(3, 0, 0), Vec3::Zero()).force.x(), 0.5 * tick, 1e-14);
  for (int tick = 1; tick <= 12; ++tick) {
    const GatedForce out = gate.apply(Vec3(-3, 0, 0), Vec3::Zero());
    EXPECT_NEAR(out.force.x(), 3.0 - 0.5 * tick, 1e-14);
    EXPECT_EQ(out.events, tick < 12 ? kGateSlew : kGateNone);
  }
}

TEST(OutputGate, WorksInTheStatedOrder) {
  // Second period: clamp 100 → 4, ramp at a quarter: 1, watchdog at a half: 0.5, slew from 0 by 0.25.
  // Slew before the ramps would give at most 0.25 · 2 · 1/4 · 1/2.
  DeviceLimits l = limits(4.0, 0.25 / kPeriod, 4 * kPeriod);
  l.watchdog.release_s = 2 * kPeriod;
  OutputGate gate(l, kPeriod);
  EXPECT_EQ(gate.apply(Vec3(100, 0, 0), Vec3::Zero()).force.x(), 0.0);
  const GatedForce out = gate.apply(Vec3(100, 0, 0), Vec3::Zero(), HandFeed::stale);
  EXPECT_NEAR(out.force.x(), 0.25, 1e-15);
  EXPECT_EQ(out.events, kGateClamped | kGateSlew | kGateRamp | kGateWatchdog);
}

TEST(OutputGate, KeepsTheSlewLimitWhileTheStartUpRampActs) {
  // A force that rises at 80 N/s under a ramp of 50 ms would go out at up to d(80 t · 20 t)/dt = 160 N/s.
  constexpr double kRate = 100.0;
  OutputGate gate(limits(10.0, kRate, 0.05), kPeriod);
  Vec3 last = Vec3::Zero();
  for (int tick = 0; tick < 100; ++tick) {
    const Vec3 out = gate.apply(Vec3(80.0 * kPeriod * tick, 0, 0), Vec3::Zero()).force;
    EXPECT_LE((out - last).norm(), kRate * kPeriod * (1.0 + 1e-12)) << tick;
    last = out;
  }
  EXPECT_NEAR(last.x(), 80.0 * kPeriod * 99, 1e-14);  // and it arrives
}

TEST(OutputGate, LetsGoOfAStaleForceNoFasterThanTheSlewLimit) {
  DeviceLimits l = limits(3.0, 500.0);  // 0.5 N a period
  l.watchdog.release_s = 0.0;
  OutputGate gate(l, kPeriod);
  for (int tick = 0; tick < 6; ++tick) gate.apply(Vec3(3, 0, 0), Vec3::Zero());
  for (int tick = 1; tick <= 8; ++tick) {
    const GatedForce out = gate.apply(Vec3(3, 0, 0), Vec3::Zero(), HandFeed::stale);
    EXPECT_NEAR(out.force.x(), std::max(0.0, 3.0 - 0.5 * tick), 1e-14);
    EXPECT_EQ(out.events, kGateWatchdog | (tick < 6 ? kGateSlew : 0)) << tick;
  }
}

TEST(OutputGate, KeepsTheSlewLimitWhenTheSamplesStartAnew) {
  OutputGate gate(limits(3.0, 500.0), kPeriod);  // 0.5 N a period
  for (int tick = 0; tick < 6; ++tick) gate.apply(Vec3(3, 0, 0), Vec3::Zero());
  const GatedForce out = gate.apply(Vec3(3, 0, 0), Vec3::Zero(), HandFeed::none);
  EXPECT_NEAR(out.force.x(), 2.5, 1e-14);
  EXPECT_EQ(out.events, kGateNoSample | kGateSlew);
}

TEST(OutputGate, SendsNothingAndLetsTheRampWaitBeforeTheFirstSample) {
  OutputGate gate(limits(3.3, kNoSlew, 2 * kPeriod), kPeriod);
  for (int tick = 0; tick < 10; ++tick) {
    const GatedForce out = gate.apply(Vec3(2, kNaN, 0), Vec3(0, 1, 0), HandFeed::none);
    EXPECT_EQ(out.force, Vec3::Zero());
    EXPECT_EQ(out.torque, Vec3::Zero());
    EXPECT_EQ(out.events, kGateNoSample);
  }
  for (const double share : {0.0, 0.5, 1.0})
    EXPECT_EQ(gate.apply(Vec3(2, 0, 0), Vec3::Zero()).force.x(), 2.0 * share);
}

TEST(OutputGate, LetsGoOfAStaleForceAndComesBackByTheSameRamp) {
  DeviceLimits l = limits(3.3, kNoSlew);
  l.watchdog.release_s = 4 * kPeriod;
  OutputGate gate(l, kPeriod);
  const auto x = [&](HandFeed feed) { return gate.apply(Vec3(2, 0, 0), Vec3(0, 0, 1), feed); };
  EXPECT_EQ(x(HandFeed::fresh).force.x(), 2.0);
  for (const double share : {0.75, 0.5, 0.25, 0.0, 0.0, 0.0}) {
    const GatedForce out = x(HandFeed::stale);
    EXPECT_EQ(out.force.x(), 2.0 * share);
    EXPECT_EQ(out.torque.z(), share);
    EXPECT_EQ(out.events, kGateWatchdog);
  }
  for (const double share : {0.25, 0.5, 0.75}) {
    const GatedForce out = x(HandFeed::fresh);
    EXPECT_EQ(out.force.x(), 2.0 * share);
    EXPECT_EQ(out.events, kGateWatchdog);
  }
  EXPECT_EQ(x(HandFeed::fresh).force.x(), 2.0);
  EXPECT_EQ(x(HandFeed::fresh).events, kGateNone);
}

TEST(OutputGate, LetsGoAtOnceWhenItsReleaseTakesNoTime) {
  DeviceLimits l = limits(3.3, kNoSlew);
  l.watchdog.release_s = 0.0;
  OutputGate gate(l, kPeriod);
  EXPECT_EQ(gate.apply(Vec3(2, 0, 0), Vec3::Zero(), HandFeed::stale).force, Vec3::Zero());
  EXPECT_EQ(gate.apply(Vec3(2, 0, 0), Vec3::Zero()).force.x(), 2.0);
}

TEST(JudgeFeed, IsStaleWhenSamplesOrPhysicsAreTooOldOrTheirAgeIsNoNumber) {
  const WatchdogLimits l{0.02, 0.1, 0.05};
  EXPECT_EQ(judge_feed(l, 1, 0.02, 0.1), HandFeed::fresh);
  EXPECT_EQ(judge_feed(l, 1, 0.021, 0.0), HandFeed::stale);
  EXPECT_EQ(judge_feed(l, 1, 0.0, 0.101), HandFeed::stale);
  EXPECT_EQ(judge_feed(l, 1, kNaN, 0.0), HandFeed::stale);
  EXPECT_EQ(judge_feed(l, 1, 0.0, kNaN), HandFeed::stale);
  EXPECT_EQ(judge_feed(l, 0, 0.0, 0.0), HandFeed::none);
}

TEST(OutputGate, ReleasesTheHandAtTheSlewRateWhenTheForceStopsBeingFinite) {
  OutputGate gate(limits(3.0, 1000.0), kPeriod);
  for (int tick = 0; tick < 3; ++tick) gate.apply(Vec3(3, 0, 0), Vec3::Zero());
  const GatedForce out = gate.apply(Vec3(kNaN, 0, 0), Vec3::Zero());
  EXPECT_NEAR(out.force.x(), 2.0, 1e-15);
  EXPECT_EQ(out.events, kGateNotFinite | kGateSlew);
}

TEST(OutputGate, ClampsTorqueOnlyWhenALimitIsStated) {
  OutputGate free(limits(3.3, kNoSlew), kPeriod);
  EXPECT_EQ(free.apply(Vec3::Zero(), Vec3(0, 0, 1e300)).torque.z(), 1e300);
  OutputGate limited(limits(3.3, kNoSlew, 0.0, 0.2), kPeriod);
  const GatedForce out = limited.apply(Vec3::Zero(), Vec3(0, 0, 1e300));
  EXPECT_NEAR(out.torque.z(), 0.2, 1e-16);
  EXPECT_EQ(out.events, kGateClamped);
}

TEST(OutputGate, KeepsItsPromiseForHostileSequences) {
  Rng rng(7, "gate");
  DeviceLimits l = limits(3.3, 800.0, 0.01, 0.1);
  l.watchdog.release_s = 0.02;
  OutputGate gate(l, kPeriod);
  constexpr double kStep = 0.8;  // a period's slew
  const double hostile[] = {kNaN, kInf, -kInf, 1e300, -1.79e308, 5e-324, -0.0, 0.0};
  Vec3 last = Vec3::Zero();
  for (int i = 0; i < 20000; ++i) {
    const auto draw = [&] {
      const std::uint64_t pick = rng.next_bits() % 16;
      return pick < 8 ? hostile[pick] : rng.uniform(-10.0, 10.0);
    };
    const Vec3 force(draw(), draw(), draw());
    const Vec3 torque(draw(), draw(), draw());
    const auto feed = rng.next_bits() % 2 == 0 ? HandFeed::fresh : HandFeed::stale;
    const GatedForce out = gate.apply(force, torque, feed);
    ASSERT_TRUE(out.force.allFinite() && out.torque.allFinite()) << i;
    constexpr double kRounding = 4e-16;  // a few ulps of the norm, relative
    ASSERT_LE(out.force.norm(), 3.3 * (1 + kRounding)) << i;
    ASSERT_LE(out.torque.norm(), 0.1 * (1 + kRounding)) << i;
    ASSERT_LE((out.force - last).norm(), kStep + 2e-15) << i;
    last = out.force;
  }
}

TEST(OutputGate, GoesOnToTheSameBitsAfterRestore) {
  const DeviceLimits l = limits(3.0, 300.0, 0.005);
  OutputGate gate(l, kPeriod);
  for (int i = 0; i < 3; ++i) gate.apply(Vec3(2, 1, 0), Vec3::Zero(), HandFeed::stale);
  OutputGate other(l, kPeriod);
  other.restore(gate.count(), gate.last_force(), gate.withdrawn());
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(other.apply(Vec3(2, 1, 0), Vec3(1, 0, 0)).force,
              gate.apply(Vec3(2, 1, 0), Vec3(1, 0, 0)).force);
  }
}

TEST(OutputGateDeathTest, RefusesLimitsThatAreNoLimits) {
  EXPECT_DEATH(OutputGate(limits(kNaN, 1.0), kPeriod), "max_force");
  EXPECT_DEATH(OutputGate(limits(1.0, 0.0), kPeriod), "max_force_rate");
}

}  // namespace
}  // namespace argil::device
