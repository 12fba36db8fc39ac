#pragma once

// A ball that presses on an elastic block by the pressure law.

#include <gtest/gtest.h>

#include <vector>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim::test {

inline constexpr double kBallRadius = 0.008;  ///< [m]
inline constexpr double kBlockHeight = 0.02;  ///< [m]
inline constexpr double kBlockModulus = 3e4;  ///< E [Pa]
inline constexpr double kBlockPoisson = 0.3;  ///< ν

inline Params make_pressure_params(int physics_period_ticks = 1,
                                   BetweenFrames between_frames = BetweenFrames::hold) {
  Params p;
  p.elastic = {kBlockModulus, kBlockPoisson};
  p.plasticity.enabled = false;
  p.kernel.form = material::KernelForm::off;
  p.contact.law = contact::ContactLaw::pressure;
  p.contact.round_tool = contact::RoundTool{kBallRadius, 0.0, kBallRadius, false};
  p.contact.grip_strength = 1e9;
  p.rates.physics_period_ticks = physics_period_ticks;
  p.rates.water_period_ticks = physics_period_ticks;
  p.rates.between_frames = between_frames;
  p.solid.rayleigh_stiffness = 2e-3;
  p.solid.solver.tolerance = 1e-9;
  p.water.wetting_flux = 1.0;
  p.device.max_force = 1e3;
  p.device.max_force_rate = 1e9;
  return p;
}

/// The ball so deep below the top of the block, off the middle of its cells.
inline device::DeviceSample press_block(double depth, double x = 0.0,
                                        device::ToolMode mode = device::ToolMode::push) {
  device::DeviceSample sample;
  sample.position = {0.0212 + x, 0.0195, kBlockHeight + kBallRadius - depth};
  sample.mode = mode;
  return sample;
}

inline Simulation make_pressed_block(const Params& params, device::ToolMode mode = device::ToolMode::push,
                                     int finer = 1, bool is_fixed = true) {
  return {argil::test::make_block_body(10 * finer, 10 * finer, 5 * finer, Vec3(0.04, 0.04, kBlockHeight), 0.0,
                                       is_fixed),
          contact::make_sphere_tool(kBallRadius, 2), params, press_block(-1e-3, 0.0, mode)};
}

/// Ticks on a straight way; the hand's force after each.
inline std::vector<Vec3> lead(Simulation& simulation, const device::DeviceSample& to, int ticks) {
  const Vec3 from = simulation.hand_state().tool.position;
  std::vector<Vec3> forces;
  for (int k = 1; k <= ticks; ++k) {
    device::DeviceSample sample = to;
    sample.position = from + (to.position - from) * (static_cast<double>(k) / ticks);
    const StepStatus status = simulation.tick(sample);
    EXPECT_TRUE(status.is_ok()) << k << ' ' << (status.is_ok() ? "" : status.failure().quantity);
    if (!status.is_ok()) break;
    forces.push_back(simulation.hand_state().hand_force);
  }
  return forces;
}

}  // namespace argil::sim::test
