// The hand as a damped oscillator about its intent, against the textbook's closed forms: step response
// (under, at and over critical damping), static deflection F/k, balance against a spring, stationary noise.
#include "device/hand_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "unit/device/intents.h"

namespace argil::device {
namespace {

constexpr double kPeriod = 0.001;
constexpr double kStep = 0.01;  // [m]

/// Response of ẍ = ω² (1 − x) − 2ζω ẋ from rest to the step at t = 0.
double step_response(double omega, double zeta, double t) {
  if (zeta == 1.0) return 1.0 - (1.0 + omega * t) * std::exp(-omega * t);
  if (zeta < 1.0) {
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    return 1.0 - std::exp(-zeta * omega * t) *
                     (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
  }
  const double root = omega * std::sqrt(zeta * zeta - 1.0);
  const double slow = -zeta * omega + root;
  const double fast = -zeta * omega - root;
  return 1.0 + (fast * std::exp(slow * t) - slow * std::exp(fast * t)) / (slow - fast);
}

TEST(HandModel, FollowsAStepOfTheIntentAsASecondOrderSystem) {
  for (const double zeta : {0.1, 0.7, 1.0, 2.5}) {
    HandParams params;
    params.mass = 0.2;
    params.stiffness = 320.0;  // ω = 40 rad/s
    params.damping = 2.0 * zeta * 40.0 * params.mass;
    HandModel hand(params, step_intent(kStep, kPeriod), kPeriod);
    for (int tick = 1; tick <= 400; ++tick) {
      const DeviceSample sample = hand.advance(Vec3::Zero());
      const double expected = kStep * step_response(40.0, zeta, tick * kPeriod);
      // Rounding: a few hundred products of a matrix whose error is some ulps.
      ASSERT_NEAR(sample.position.x(), expected, 1e-12 * kStep) << zeta << ", tick " << tick;
      ASSERT_EQ(sample.position.y(), 0.0);
    }
  }
}

TEST(HandModel, YieldsToAConstantForceByForceOverStiffness) {
  HandParams params;
  params.stiffness = 250.0;
  HandModel hand(params, resting_intent(Vec3(0.1, 0.2, 0.3)), kPeriod);
  DeviceSample sample;
  for (int tick = 0; tick < 10000; ++tick) sample = hand.advance(Vec3(1.0, -2.0, 0.5));
  EXPECT_NEAR((sample.position - Vec3(0.104, 0.192, 0.302)).norm(), 0.0, 1e-15);
}

TEST(HandModel, StaysWhereItMeansToBeToTheBit) {
  const Vec3 place(0.1, -0.2, 0.3);
  HandModel hand({}, resting_intent(place), kPeriod);
  for (int tick = 0; tick < 100; ++tick) EXPECT_EQ(hand.advance(Vec3::Zero()).position, place);
}

TEST(HandModel, ReactsSoMuchLater) {
  HandParams late;
  late.reaction_delay = 0.15;
  const Trace intent = step_intent(kStep, kPeriod, ToolMode::pull);
  HandModel now({}, intent, kPeriod);
  HandModel later(late, intent, kPeriod);
  for (int tick = 1; tick <= 150; ++tick) {
    const DeviceSample sample = later.advance(Vec3::Zero());
    ASSERT_NEAR(sample.position.x(), 0.0, 1e-15) << tick;
    ASSERT_EQ(sample.mode, ToolMode::push) << tick;
  }
  for (int tick = 151; tick <= 500; ++tick) {
    const DeviceSample sample = later.advance(Vec3::Zero());
    ASSERT_NEAR(sample.position.x(), now.advance(Vec3::Zero()).position.x(), 1e-12 * kStep) << tick;
    ASSERT_EQ(sample.mode, ToolMode::pull) << tick;
  }
}

TEST(HandModel, TremblesByTheStatedAmountAtTheStatedFrequency) {
  HandParams params;  // so stiff that the hand is where it means to be: (9 Hz / 1592 Hz)² = 3e-5
  params.mass = 0.001;
  params.stiffness = 1e5;
  params.damping = 2.0 * 0.001 * 1e4;
  params.tremor = 2e-4;
  HandModel hand(params, resting_intent(Vec3::Zero()), kPeriod);
  constexpr int kTicks = 1000000;
  Vec3 squares = Vec3::Zero();
  int upward = 0;
  double last = 0.0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const Vec3 x = hand.advance(Vec3::Zero()).position;
    squares += x.cwiseAbs2();
    upward += last < 0.0 && x.x() >= 0.0 ? 1 : 0;
    last = x.x();
  }
  // 1000 s of a process that forgets in 1/(ζω) = 0.18 s: the deviation is known to about 1 %. Zeros are
  // crossed upward at the resonance [Rice 1944: √(σ_v²/σ_x²)/2π, and white noise gives σ_v = ω σ_x].
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squares[axis] / kTicks) / params.tremor, 1.0, 0.05) << axis;
  EXPECT_NEAR(upward / (kTicks * kPeriod) / params.tremor_frequency, 1.0, 0.03);
}

TEST(HandModel, GivesTheSameBitsForTheSameForcesAndOthersForAnotherSeed) {
  HandParams params;
  params.tremor = 1e-4;
  const Trace intent = step_intent(kStep, kPeriod);
  HandModel one(params, intent, kPeriod);
  HandModel same(params, intent, kPeriod);
  params.seed = 2;
  HandModel other(params, intent, kPeriod);
  bool differs = false;
  for (int tick = 0; tick < 1000; ++tick) {
    const Vec3 force(0.001 * tick, -0.5, 0.25);
    const Vec3 x = one.advance(force).position;
    ASSERT_EQ(x, same.advance(force).position);
    differs = differs || x != other.advance(force).position;
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace argil::device
