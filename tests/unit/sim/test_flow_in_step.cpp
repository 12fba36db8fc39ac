// Clay that flows under a ball at the speed of a hand: steps of a millisecond feel it as steps of a tenth do.
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

/// Force at the hand at the end of each millisecond [N].
std::vector<double> press(int ticks_per_ms) {
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
  const auto sample = [](double t) {
    device::DeviceSample at;
    at.position = {0.0212, 0.0195, kTop + kRadius - depth_at(t)};
    return at;
  };
  Simulation simulation(test::make_block_body(10, 10, 5, Vec3(0.04, 0.04, kTop)),
                        contact::make_sphere_tool(kRadius, 2), p, sample(-1e-3));
  std::vector<double> forces;
  for (int k = 1; k <= 110 * ticks_per_ms; ++k) {
    EXPECT_TRUE(simulation.tick(sample(k * p.rates.haptic_period)).is_ok()) << k;
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

}  // namespace
}  // namespace argil::sim
