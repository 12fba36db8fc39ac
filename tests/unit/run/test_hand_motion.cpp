// A hand that yields: balance of its spring with the force that it feels.
#include <gtest/gtest.h>

#include "output/result_reader.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::run {
namespace {

/// A press that stays: 2 mm deep from 0.1 s on.
std::string write_hold(const std::string& file) {
  return test::write_text(
      file,
      "t,x,y,z,mode\n0,0.001,0.0007,0.048,push\n0.1,0.001,0.0007,0.044,push\n"
      "0.2,0.001,0.0007,0.044,push\n0.3,0.001,0.0007,0.044,push\n"
      "0.4,0.001,0.0007,0.044,push\n0.5,0.001,0.0007,0.044,push\n0.6,0.001,0.0007,0.044,push\n");
}

std::vector<sim::HapticRecord> run_press(const test::TempFolder& folder, std::vector<std::string> settings) {
  RunOptions options;
  options.scenario =
      test::write_text(folder / "ball.json", test::make_ball_scenario(write_hold(folder / "hold.csv")));
  options.output = folder / "out.h5";
  options.quiet = true;
  settings.emplace_back("/material/plasticity/enabled=false");
  options.settings = std::move(settings);
  EXPECT_EQ(run(options), kDone);
  return output::ResultReader(options.output).read_haptic();
}

TEST(HandMotion, AtRestTheHandsSpringBalancesTheForce) {
  constexpr double kStiffness = 100.0;  // [N/m]
  test::TempFolder folder;
  const auto told = run_press(folder, {});
  const auto yields = run_press(folder, {"/hand/kind=simulated", "/hand/stiffness_N_per_m=100"});
  ASSERT_EQ(told.size(), yields.size());
  const sim::HapticRecord& last = yields.back();
  EXPECT_NEAR(last.tool_position.z() - 0.044, last.device_force.z() / kStiffness, 1e-6);
  EXPECT_GT(last.device_force.z(), 0.01);
  EXPECT_GT(last.tool_position.z(), 0.0441);
  EXPECT_LT(last.device_force.z(), told.back().device_force.z());
  EXPECT_EQ(told.back().tool_position.z(), 0.044);
}

TEST(HandMotion, DelayedHandComesSoMuchLater) {
  // Free of any force, before the tool touches.
  test::TempFolder folder;
  const auto now = run_press(folder, {"/hand/kind=simulated"});
  const auto late = run_press(folder, {"/hand/kind=simulated", "/hand/reaction_delay_s=0.02"});
  for (std::size_t k = 0; k < 15; ++k)
    EXPECT_NEAR(late[k + 20].tool_position.z(), now[k].tool_position.z(), 1e-12) << k;
}

}  // namespace
}  // namespace argil::run
