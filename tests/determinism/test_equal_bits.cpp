// Equal binary, scenario and trace give equal results, at any number of threads and over two runs: every
// dataset of the result file and the state hash of every frame, all but the timing.
#include <gtest/gtest.h>

#include <limits>

#include "output/compare.h"
#include "output/result_reader.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

struct Case {
  const char* name;
  const char* mode;  // of the tool
  std::vector<std::string> settings = {};
  bool solves_parts = false;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class EqualBits : public testing::TestWithParam<Case> {};

TEST_P(EqualBits, AtOneAndMoreThreadsAndOverTwoRuns) {
  const test::TempFolder folder;
  const std::string trace =
      test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.3, GetParam().mode);
  run::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "ball.json", test::make_ball_scenario(trace));
  options.settings = GetParam().settings;
  options.output = folder / "first.h5";
  ASSERT_EQ(run::run(options), run::kDone);
  for (const int threads : {1, 2, 7}) {
    options.threads = threads;
    options.output = folder / ("again" + std::to_string(threads) + ".h5");
    ASSERT_EQ(run::run(options), run::kDone);
    const output::CompareReport report = output::compare_results(folder / "first.h5", options.output, {});
    EXPECT_TRUE(report.is_equal()) << threads << " threads\n" << to_string(report);
    EXPECT_GT(report.num_compared, 100U);
  }
  int least = std::numeric_limits<int>::max(), most = 0;
  for (const sim::PhysicsRecord& record : output::ResultReader(folder / "first.h5").read_physics()) {
    if (record.active_nodes == 0) continue;
    least = std::min(least, record.active_nodes);
    most = std::max(most, record.active_nodes);
  }
  EXPECT_EQ(least < most, GetParam().solves_parts);
}

// A pulling contact draws the body deeper into the tool, where it pulls harder: stable only while it is the
// softer.
const std::string kSoft[] = {"/contact/vertex_face_stiffness_N_per_m=5",
                             "/contact/edge_edge_stiffness_N_per_m=5"};
const std::string kAuto = "/fidelity/mode=auto";

INSTANTIATE_TEST_SUITE_P(
    Modes, EqualBits,
    testing::Values(Case{"push", "push"}, Case{"pull", "pull", {kSoft[0], kSoft[1]}}, Case{"wet", "wet"},
                    Case{"dry", "dry"}, Case{"push_auto", "push", {kAuto}},
                    Case{"pull_auto", "pull", {kAuto, kSoft[0], kSoft[1]}}, Case{"wet_auto", "wet", {kAuto}},
                    Case{"region", "push", {kAuto, "/body/shape/target_tets=12000"}, true}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(EqualBits, ADifferentStiffnessIsSeenByTheComparison) {
  const test::TempFolder folder;
  const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.2, "push");
  run::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "ball.json", test::make_ball_scenario(trace));
  options.output = folder / "a.h5";
  ASSERT_EQ(run::run(options), run::kDone);
  options.settings = {"/material/youngs_modulus_Pa=100000.00001"};
  options.output = folder / "b.h5";
  ASSERT_EQ(run::run(options), run::kDone);
  EXPECT_FALSE(output::compare_results(folder / "a.h5", folder / "b.h5", {}).is_equal());
}

}  // namespace
}  // namespace argil
