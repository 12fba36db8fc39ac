// A run that a program steps is the run of the command line: the same start, ticks, record and end.
#include <gtest/gtest.h>

#include <csignal>

#include "base/error.h"
#include "base/read_file.h"
#include "output/compare.h"
#include "output/result_reader.h"
#include "run/interrupt.h"
#include "run/run.h"
#include "run/stepper.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

volatile std::sig_atomic_t g_signals = 0;

class Stepped : public testing::Test {
 protected:
  test::TempFolder folder;
  run::RunOptions options;

  void SetUp() override {
    options.quiet = true;
    options.settings = {"/haptics/frame_period_ticks=20"};
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.05, "push");
    options.scenario = folder.write("scene.json", test::make_ball_scenario(trace));
    options.output = folder / "run.h5";
  }
  std::string compare(const std::string& record) const {
    return to_string(output::compare_results(options.output, record, {}));
  }
};

TEST_F(Stepped, AlongTheMotionItLeavesTheFileOfARun) {
  ASSERT_EQ(run::run(options), run::kDone);
  run::Stepper stepper(run::load(options), {folder / "stepped.h5", "", std::nullopt});
  ASSERT_EQ(stepper.num_ticks(), 50);
  for (Tick k = 0; k < stepper.num_ticks(); ++k) ASSERT_TRUE(stepper.tick().is_ok());
  ARGIL_EXPECT_THROW_WITH((void)stepper.tick(), InputError, "the scenario's motion has 50 ticks");
  stepper.finish();
  EXPECT_TRUE(compare(folder / "stepped.h5").starts_with("equal")) << compare(folder / "stepped.h5");
}

TEST_F(Stepped, WithAHandThatGoesTheSameWayItHasTheSameForcesAndNamesNoTrace) {
  ASSERT_EQ(run::run(options), run::kDone);
  const std::vector<sim::HapticRecord> wanted = output::ResultReader(options.output).read_haptic();
  run::Stepper stepper(run::load(options), {folder / "own.h5", "", std::nullopt});
  double largest = 0.0;
  for (const sim::HapticRecord& record : wanted) {
    ASSERT_TRUE(stepper.tick({record.tool_position, record.tool_orientation, record.mode}).is_ok());
    EXPECT_EQ(stepper.simulation().haptic_record().force, record.force);
    largest = std::max(largest, record.force.norm());
  }
  stepper.finish();
  EXPECT_GT(largest, 0.1);
  const output::ResultReader own(folder / "own.h5");
  EXPECT_EQ(own.outcome(), output::Outcome::done);
  EXPECT_EQ(own.find_provenance("trace_sha256"), "");
  EXPECT_NE(own.find_provenance("run_id"), output::ResultReader(options.output).find_provenance("run_id"));
}

TEST_F(Stepped, ARunHasOneHand) {
  run::Stepper stepper(run::load(options), {});
  const device::DeviceSample away{Vec3(0, 0, 0.06), Quat::Identity(), device::ToolMode::push};
  ASSERT_TRUE(stepper.tick(away).is_ok());
  ARGIL_EXPECT_THROW_WITH((void)stepper.tick(), InputError, "the hand has been a program's own so far");
  device::DeviceSample turned = away;
  turned.orientation = Quat(2.0, 0.0, 0.0, 0.0);
  ARGIL_EXPECT_THROW_WITH((void)stepper.tick(turned), InputError,
                          "tick 2: the hand's orientation is no unit");
}

TEST_F(Stepped, OneThatIsLeftEarlyIsInterrupted) {
  run::Stepper stepper(run::load(options), {folder / "early.h5", "", std::nullopt});
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(stepper.tick().is_ok());
  stepper.finish();
  EXPECT_EQ(output::ResultReader(folder / "early.h5").outcome(), output::Outcome::interrupted);
  ARGIL_EXPECT_THROW_WITH((void)stepper.tick(), InputError, "comes after the record's end");
}

TEST_F(Stepped, AScenarioThatLiesInNoFileIsTheSame) {
  ASSERT_EQ(run::run(options), run::kDone);
  run::RunOptions text = options;
  text.text = read_file(options.scenario);
  text.scenario = folder / "nothing";
  text.output = folder / "text.h5";
  ASSERT_EQ(run::run(text), run::kDone);
  EXPECT_TRUE(compare(text.output).starts_with("equal")) << compare(text.output);
  text.settings = {"/material/youngs=1"};
  ARGIL_EXPECT_THROW_WITH(run::run(text), InputError, "nothing: /material/youngs: is not a known key");
}

TEST(SignalGuest, SignalsDoAfterwardsWhatTheyDidBefore) {
  const auto before = std::signal(SIGINT, [](int) { g_signals = g_signals + 1; });
  {
    const run::SignalGuest guest;
    run::watch_signals();
    EXPECT_EQ(guest.caught(), 0);
    std::raise(SIGINT);
    EXPECT_EQ(guest.caught(), SIGINT);
    EXPECT_EQ(g_signals, 0);
  }
  std::raise(SIGINT);
  EXPECT_EQ(g_signals, 1);
  EXPECT_EQ(run::SignalGuest().caught(), 0);
  std::signal(SIGINT, before);
}

}  // namespace
}  // namespace argil
