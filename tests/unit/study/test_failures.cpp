// A failure of a map is stored as its smallest scenario: what is left can be told beforehand, or is seen not
// to fail any more when it is made smaller still.
#include "study/failures.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "output/result_reader.h"
#include "run/run.h"
#include "scenario/build.h"
#include "scenario/study_file.h"
#include "study/measure.h"
#include "study/stability.h"
#include "study_scene.h"

namespace argil::study {
namespace {

class Failures : public Study {
 protected:
  /// Runs a map and gives the scenario that it keeps of `outcome`.
  std::string keep(const std::string& study, const std::string& outcome) const {
    EXPECT_EQ(map_stability(options(study), folder / "failures"), run::kDone);
    EXPECT_EQ(table().at(0).at("outcome"), outcome);
    return folder / ("failures/study_" + outcome + ".json");
  }
  /// The result of a scenario with settings.
  std::string run_file(const std::string& scenario, const std::vector<std::string>& settings, int expected,
                       const std::string& name = "again.h5") const {
    run::RunOptions options;
    options.quiet = true;
    options.scenario = scenario;
    options.settings = settings;
    options.output = folder / name;
    testing::internal::CaptureStderr();
    EXPECT_EQ(run::run(options), expected);
    testing::internal::GetCapturedStderr();
    return options.output;
  }
  RunErrors compare(const std::string& scenario, const std::string& reference,
                    std::vector<std::string> settings = {}) const {
    const output::ResultReader result(run_file(scenario, settings, run::kDone));
    settings.push_back(reference);
    const output::ResultReader truth(run_file(scenario, settings, run::kDone, "truth.h5"));
    return compute_errors(result, truth);
  }
  double find_peak(const std::string& scenario, const std::vector<std::string>& settings = {}) const {
    return compute_peak_force(output::ResultReader(run_file(scenario, settings, run::kDone)).read_haptic());
  }
  static std::string set(const std::string& pointer, double value) {
    return pointer + "=" + std::to_string(value);
  }
};

// Tets may not lose a thousandth of their volume: any mesh fails, in the tick in which the tool has pressed
// it so far, and nothing else that the study sets has to do with it.
TEST_F(Failures, ThatEndEarlyKeepWhatTheyNeedAlone) {
  const std::string file = keep(
      R"({"about": "x", "scenario": "scene.json", "x": {"name": "x", "pointers": ["/material/poissons_ratio"],
          "values": [0.35]}, "settings": {"/material/density_kg_per_m3": 1400, "/body/shape/target_tets": 400,
          "/dynamics/min_volume_ratio": 0.999, "/haptics/frame_period_ticks": 25, "/water/porosity": 0.31}})",
      "inverted");
  const scenario::Scenario s = scenario::load_scenario(file, {});
  const scenario::Scenario base = scenario::load_scenario(folder / "scene.json", {});
  EXPECT_EQ(s.params.solid.min_volume_ratio, 0.999);
  EXPECT_EQ(s.params.solid.density, base.params.solid.density);
  EXPECT_EQ(s.params.rates.frame_period_ticks, base.params.rates.frame_period_ticks);
  EXPECT_EQ(s.params.water.porosity, base.params.water.porosity);
  EXPECT_EQ(s.body.target_tets, 100);  // the fewest that a scenario may ask for
  // It ends in its last tick.
  const auto failure = output::ResultReader(run_file(file, {}, run::kRunFailed)).read_failure();
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->quantity.find("volume ratio"), 0U) << failure->quantity;
  EXPECT_DOUBLE_EQ(s.trace.duration, 1e-3 * static_cast<double>(failure->tick));
  run_file(file, {set("/trace/duration_s", 1e-3 * static_cast<double>(failure->tick - 1))}, run::kDone);
}

// Clay of half the modulus is wrong for as long as it is pressed: the motion may end when half of the largest
// force is felt, of which the rule makes an end.
TEST_F(Failures, OfWrongForcesAreShortenedToWhereTheyAreFelt) {
  const std::string truth = "/material/youngs_modulus_Pa=40000";
  const std::string file = keep(
      R"({"about": "x", "scenario": "scene.json", "x": {"name": "E [Pa]", "values": [2e4],
          "pointers": ["/material/youngs_modulus_Pa"]}, "reference": {"/material/youngs_modulus_Pa": 4e4},
          "settings": {"/material/density_kg_per_m3": 1400, "/water/porosity": 0.31}})",
      "wrong");
  const scenario::Scenario s = scenario::load_scenario(file, {});
  EXPECT_EQ(s.params.solid.density, 1500.0);
  EXPECT_EQ(s.params.water.porosity,
            scenario::load_scenario(folder / "scene.json", {}).params.water.porosity);
  EXPECT_LT(s.trace.duration, 0.2);  // the tool turns back there
  EXPECT_GT(compare(file, truth).force, 0.1);
  const double half = 0.5 * find_peak(folder / "scene.json", {"/material/density_kg_per_m3=1400"});
  EXPECT_GE(find_peak(file), half);
  for (const double share : {0.5, 0.75, 0.875}) {
    EXPECT_LT(find_peak(file, {set("/trace/duration_s", share * s.trace.duration)}), half) << share;
  }
}

TEST_F(Failures, OfChatterAreShortenedToFivePeriodsOrWhereTheyAreFelt) {
  const std::string file = keep(
      R"({"about": "x", "scenario": "scene.json", "settings": {"/dynamics/implicit_contact": false,
          "/haptics/physics_period_ticks": 10, "/haptics/water_period_ticks": 10,
          "/contact/edge_edge_stiffness_N_per_m": 2000}, "x": {"name": "k", "values": [2000],
          "pointers": ["/contact/vertex_face_stiffness_N_per_m"]},
          "reference": {"/dynamics/implicit_contact": true, "/haptics/physics_period_ticks": 1}})",
      "chatter");
  const scenario::Scenario s = scenario::load_scenario(file, {});
  EXPECT_GE(s.trace.duration, 0.1);
  EXPECT_LT(s.trace.duration, 0.3);
  EXPECT_FALSE(s.params.solid.implicit_contact);  // or it would not chatter
  const output::ResultReader result(run_file(file, {}, run::kDone));
  EXPECT_GT(compute_figures(result, s).chatter, 0.1);
}

}  // namespace
}  // namespace argil::study
