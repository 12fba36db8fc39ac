// `fidelity: check` beside separate runs in full and with auto: what it records is how far they differ.
#include <gtest/gtest.h>

#include <algorithm>

#include "output/result_reader.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::run {
namespace {

class FidelityCheck : public testing::TestWithParam<int> {};

TEST_P(FidelityCheck, RecordsTheLargestDifferenceFromAFullRunSinceTheLastStep) {
  const int period = GetParam();  // ticks a step
  const test::TempFolder folder;
  const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.3, "push");
  RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "ball.json", test::make_ball_scenario(trace));
  const auto run_in = [&](const std::string& mode) {
    options.settings = {"/fidelity/mode=" + mode, "/haptics/physics_period_ticks=" + std::to_string(period)};
    options.output = folder / (mode + ".h5");
    EXPECT_EQ(run(options), kDone);
    return output::ResultReader(options.output);
  };
  const auto full = run_in("full").read_haptic();
  const auto lean = run_in("auto").read_haptic();
  const output::ResultReader check = run_in("check");
  const auto checked = check.read_haptic();
  const auto records = check.find_fidelity();
  ASSERT_TRUE(records);
  ASSERT_EQ(full.size(), lean.size());
  ASSERT_EQ(records->size(), full.size() / static_cast<std::size_t>(period));
  double largest = 0.0;
  for (std::size_t tick = 0, step = 0; step < records->size(); ++step) {
    double error = 0.0;
    for (const std::size_t end = tick + static_cast<std::size_t>(period); tick < end; ++tick) {
      EXPECT_EQ(checked[tick].force, lean[tick].force);  // auto itself, to the bit
      error = std::max(error, (lean[tick].force - full[tick].force).norm());
    }
    EXPECT_EQ((*records)[step].error, error) << step;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 0.0);
}

INSTANTIATE_TEST_SUITE_P(TicksAStep, FidelityCheck, testing::Values(1, 5));

}  // namespace
}  // namespace argil::run
