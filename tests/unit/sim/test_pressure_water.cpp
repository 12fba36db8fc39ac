// The pressure law follows the modulus that the clay has now.

#include <gtest/gtest.h>

#include "unit/sim/pressure_scene.h"

namespace argil::sim {
namespace {

using device::ToolMode;
using test::lead;
using test::make_pressed_block;
using test::make_pressure_params;
using test::press_block;

constexpr double kWetOverDry = 0.4;  // of Young's modulus

Params make_softening_params(int physics_period_ticks) {
  Params params = make_pressure_params(physics_period_ticks);
  params.moisture.law = material::MoistureLaw::table;
  params.moisture.table_saturation = {0.0, 1.0};
  params.moisture.table_youngs_modulus = {test::kBlockModulus, kWetOverDry * test::kBlockModulus};
  params.moisture.table_yield = {0.1, 0.1};
  params.water.wetting_flux = 1e6;  // soaks what it touches at once
  return params;
}

const Eigen::MatrixXd& stiffness_of(const Snapshot& snapshot) {
  return snapshot.at("contact/stiffness_per_area");
}

class SoakedClay : public testing::TestWithParam<int> {};

/// Hertz's force is in proportion to the modulus.
TEST_P(SoakedClay, IsFeltSofterUnderAToolThatWets) {
  Simulation simulation = make_pressed_block(make_softening_params(GetParam()), ToolMode::wet);
  lead(simulation, press_block(1e-3, 0.0, ToolMode::wet), GetParam());
  lead(simulation, press_block(1e-3, 0.0, ToolMode::wet), 4 * GetParam());
  Params params = make_softening_params(GetParam());
  params.water.wetting_flux = 0.0;
  Simulation dry = make_pressed_block(params, ToolMode::wet);
  lead(dry, press_block(1e-3, 0.0, ToolMode::wet), GetParam());
  lead(dry, press_block(1e-3, 0.0, ToolMode::wet), 4 * GetParam());
  ASSERT_GT(dry.hand_state().hand_force.z(), 0.05);
  EXPECT_NEAR(simulation.hand_state().hand_force.z() / dry.hand_state().hand_force.z(), kWetOverDry, 1e-3);
}

/// What the hand knows of the stiffness is the body's own, at every tick, also after one that failed.
TEST_P(SoakedClay, HasThePenaltyOfItsPresentModulus) {
  Params params = make_softening_params(GetParam());
  params.solid.min_volume_ratio = 0.6;
  params.water.diffusivity = 1e-4;
  Simulation simulation = make_pressed_block(params, ToolMode::wet);
  const Eigen::MatrixXd dry = stiffness_of(simulation.take_snapshot());
  lead(simulation, press_block(1e-3, 0.0, ToolMode::wet), 20 * GetParam());
  const Eigen::MatrixXd wet = stiffness_of(simulation.take_snapshot());
  EXPECT_LT((wet.array() / dry.array()).minCoeff(), 0.8);
  EXPECT_EQ(wet, Eigen::MatrixXd(simulation.body_side().find_surface_stiffness().per_area));
  lead(simulation, press_block(-1e-3, 0.0, ToolMode::push), 2 * GetParam());
  Eigen::MatrixXd before;
  bool is_ok = true;
  for (int k = 0; k < 200 && is_ok; ++k) {  // water diffuses in each of these
    before = stiffness_of(simulation.take_snapshot());
    is_ok = simulation.tick(press_block(1e-3 * k / GetParam())).is_ok();
  }
  ASSERT_FALSE(is_ok);
  EXPECT_EQ(stiffness_of(simulation.take_snapshot()), before);
  EXPECT_EQ(stiffness_of(simulation.take_snapshot()),
            Eigen::MatrixXd(simulation.body_side().find_surface_stiffness().per_area));
}

INSTANTIATE_TEST_SUITE_P(Ticks, SoakedClay, testing::Values(1, 7));

}  // namespace
}  // namespace argil::sim
