// Clay that flows under a ball at the speed of a hand: steps of a millisecond feel it as steps of a tenth do,
// and it is let go without harm.
#include <gtest/gtest.h>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim {
namespace {

constexpr double kRadius = 0.008;
constexpr double kTop = 0.02;
constexpr double kSpeed = 0.03;  // [m/s]
constexpr double kDeepest = 1.5e-3;
constexpr double kHeld = 0.02;  // [s]

/// In, at rest, and off again.
double depth_at(double t) {
  constexpr double kIn = kDeepest / kSpeed;
  if (t < kIn) return kSpeed * t;
  return t < kIn + kHeld ? kDeepest : kDeepest - kSpeed * (t - kIn - kHeld);
}

Params make_params(int ticks_per_ms) {
  Params p;
  p.elastic = {1.2e6, 0.3};
  p.plasticity.form = material::FlowForm::j2;
  p.plasticity.strength = 15e3;
  p.kernel.form = material::KernelForm::off;
  p.contact.law = contact::ContactLaw::pressure;
  p.contact.round_tool = contact::RoundTool{kRadius, 0.0, kRadius, false};
  p.solid.model = solid::StrainModel::hencky;
  p.rates.haptic_period = 1e-3 / ticks_per_ms;
  p.rates.water_period_ticks = 1;
  p.device.max_force = 1e3;
  return p;
}

device::DeviceSample place_at(double depth) {
  device::DeviceSample at;
  at.position = {0.0212, 0.0195, kTop + kRadius - depth};
  return at;
}

Simulation make_press(const Params& p) {
  return Simulation(test::make_block_body(10, 10, 5, Vec3(0.04, 0.04, kTop)),
                    contact::make_sphere_tool(kRadius, 2), p, place_at(depth_at(-1e-3)));
}

/// Force at the hand at the end of each millisecond [N].
std::vector<double> press(int ticks_per_ms) {
  const Params p = make_params(ticks_per_ms);
  Simulation simulation = make_press(p);
  std::vector<double> forces;
  for (int k = 1; k <= 110 * ticks_per_ms; ++k) {
    EXPECT_TRUE(simulation.tick(place_at(depth_at(k * p.rates.haptic_period))).is_ok()) << k;
    if (k % ticks_per_ms == 0) forces.push_back(simulation.hand_state().hand_force.z());
  }
  return forces;
}

TEST(FlowInAStep, IsFeltInStepsOfAMillisecondAsInMuchShorterOnes) {
  const std::vector<double> forces = press(1), fine = press(10);
  const double peak = *std::max_element(fine.begin(), fine.end());
  ASSERT_GT(peak, 1.0);
  double largest = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    largest = std::max(largest, std::abs(forces[i] - fine[i]));
    squares += (forces[i] - fine[i]) * (forces[i] - fine[i]);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(fine.size())), 0.01 * peak);
  EXPECT_LT(largest, 0.04 * peak);
}

TEST(FlowInAStep, WhatTheContactGaveIsStoredOrLost) {
  // Backward Euler loses energy besides, to first order in the step; it makes none.
  double of_long_steps = 0.0;
  for (const int ticks_per_ms : {1, 4}) {
    const Params p = make_params(ticks_per_ms);
    Simulation simulation = make_press(p);
    double over = 0.0;
    for (int k = 1; k <= 50 * ticks_per_ms; ++k) {
      ASSERT_TRUE(simulation.tick(place_at(depth_at(k * p.rates.haptic_period))).is_ok()) << k;
      const PhysicsRecord r = simulation.physics_record();
      over = std::max(over, r.elastic_energy + r.kinetic_energy + r.plastic_dissipation - r.contact_work);
    }
    const PhysicsRecord pressed = simulation.physics_record();
    ASSERT_GT(pressed.plastic_dissipation, pressed.elastic_energy);
    EXPECT_LT(over, 1e-3 * pressed.contact_work);
    const double lost =
        1.0 - (pressed.elastic_energy + pressed.kinetic_energy + pressed.plastic_dissipation) /
                  pressed.contact_work;
    EXPECT_LT(lost, 0.04);
    if (ticks_per_ms == 1)
      of_long_steps = lost;
    else
      EXPECT_LT(lost, 0.4 * of_long_steps);
  }
}

/// Steps make the more of a misjudged stiffness the longer they are.
class LetGo : public testing::TestWithParam<int> {};

TEST_P(LetGo, ClayAtItsYieldLosesNoMoreEnergyThanItHad) {
  Params p = make_params(1);
  p.rates.physics_period_ticks = p.rates.water_period_ticks = GetParam();
  p.contact.grip_strength = 1e9;
  Simulation simulation = make_press(p);
  const auto go = [&](double from, double to, int ticks, device::ToolMode mode) {
    for (int k = 1; k <= ticks; ++k) {
      device::DeviceSample at = place_at(from + (to - from) * k / ticks);
      at.mode = mode;
      ASSERT_TRUE(simulation.tick(at).is_ok()) << k;
    }
  };
  go(0.0, kDeepest, 60, device::ToolMode::push);
  go(kDeepest, -2.0 * kDeepest, 120, device::ToolMode::pull);  // clay follows, and flows
  const PhysicsRecord held = simulation.physics_record();
  ASSERT_LT(simulation.hand_state().hand_force.z(), -1.0);
  ASSERT_GT(held.plastic_dissipation, held.elastic_energy);
  go(-0.02, -0.02, 120, device::ToolMode::push);  // gone
  const PhysicsRecord left = simulation.physics_record();
  EXPECT_NEAR(left.contact_work, held.contact_work, 1e-9 * held.contact_work);
  EXPECT_LE(left.plastic_dissipation + left.elastic_energy + left.kinetic_energy,
            held.plastic_dissipation + held.elastic_energy + held.kinetic_energy);
  EXPECT_LT(left.kinetic_energy, 1e-6 * held.elastic_energy);  // and is at rest
}

INSTANTIATE_TEST_SUITE_P(Steps, LetGo, testing::Values(1, 2, 5),
                         [](const auto& ticks) { return std::to_string(ticks.param) + "_ms"; });

}  // namespace
}  // namespace argil::sim
