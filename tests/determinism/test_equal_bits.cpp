// Equal binary, scenario and trace give equal results, at any number of threads and over two runs: every
// dataset of the result file and the state hash of every frame, all but the timing.
#include <gtest/gtest.h>

#include "output/compare.h"
#include "output/result_reader.h"
#include "study/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

class EqualBits : public testing::TestWithParam<const char*> {};

TEST_P(EqualBits, AtOneAndMoreThreadsAndOverTwoRuns) {
  const test::TempFolder folder;
  const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.3, GetParam());
  study::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "ball.json", test::make_ball_scenario(trace));
  // A pulling contact draws the body deeper into the tool, where it pulls harder: stable only while it is the
  // softer.
  if (GetParam() == std::string("pull"))
    options.settings = {"/contact/vertex_face_stiffness_N_per_m=5", "/contact/edge_edge_stiffness_N_per_m=5"};
  options.output = folder / "first.h5";
  ASSERT_EQ(study::run(options), study::kDone);
  for (const int threads : {1, 2, 7}) {
    options.threads = threads;
    options.output = folder / ("again" + std::to_string(threads) + ".h5");
    ASSERT_EQ(study::run(options), study::kDone);
    const output::CompareReport report = output::compare_results(folder / "first.h5", options.output, {});
    EXPECT_TRUE(report.is_equal()) << threads << " threads\n" << to_string(report);
    EXPECT_GT(report.num_compared, 100U);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, EqualBits, testing::Values("push", "pull", "wet", "dry"));

TEST(EqualBits, ADifferentStiffnessIsSeenByTheComparison) {
  const test::TempFolder folder;
  const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.2, "push");
  study::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "ball.json", test::make_ball_scenario(trace));
  options.output = folder / "a.h5";
  ASSERT_EQ(study::run(options), study::kDone);
  options.settings = {"/material/youngs_modulus_Pa=100000.00001"};
  options.output = folder / "b.h5";
  ASSERT_EQ(study::run(options), study::kDone);
  EXPECT_FALSE(output::compare_results(folder / "a.h5", folder / "b.h5", {}).is_equal());
}

}  // namespace
}  // namespace argil
