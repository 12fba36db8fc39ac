// What a run made simpler, from the scenario that its file keeps. Expected words: the meaning that the
// reference page gives to each setting.
#include "scenario/model_summary.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "scenario/scenario.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::scenario {
namespace {

class ModelSummary : public testing::Test {
 protected:
  test::TempFolder folder;
  std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  std::string file = folder.write("scene.json", test::make_ball_scenario("press.csv"));

  std::string describe(const std::vector<std::string>& settings) const {
    std::vector<Setting> parsed;
    for (const std::string& text : settings) parsed.push_back(parse_setting(text));
    return describe_model(print_resolved(load_scenario(file, parsed)), file);
  }
  void expect_line(const std::vector<std::string>& settings, const std::string& line) const {
    const std::string text = describe(settings);
    EXPECT_NE(('\n' + text).find('\n' + line), std::string::npos) << line << "\nin\n" << text;
  }
};

TEST_F(ModelSummary, EveryKeyThatItAsksForIsInAResolvedScenario) {
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{}, {"/dynamics/mode=static"}, {"/dynamics/iteration=newton"}})
    EXPECT_EQ(describe(settings).find("not said"), std::string::npos) << describe(settings);
}

TEST_F(ModelSummary, NamesLawElementStepAndSolver) {
  expect_line({"/dynamics/model=linear"}, "simplified  strain: linear");
  expect_line({"/dynamics/model=neo_hookean"}, "in full     strain: large");
  expect_line({"/dynamics/model=hencky", "/material/plasticity/enabled=false"},
              "in full     strain: large (logarithmic");
  expect_line({"/dynamics/element=p1_nodal"}, "simplified  elements: one strain a tet, volume averaged");
  expect_line({"/dynamics/element=p2"}, "in full     elements: linear strain");
  expect_line({"/dynamics/iteration=newton", "/dynamics/newton/tolerance=1e-9"},
              "in full     time: Newton's method in a step of 1 ms (backward_euler) to 1e-09");
  expect_line({"/dynamics/integrator=symplectic_euler"}, "simplified  time: a step of 1 ms, explicit");
  expect_line({"/dynamics/solver/kind=pcg", "/dynamics/solver/tolerance=1e-5"},
              "simplified  linear solve: iterative, to a residual of 1e-05");
  expect_line({"/dynamics/solver/kind=supernodal"}, "in full     linear solve: direct (supernodal)");
  expect_line({"/dynamics/allow_locking=true"}, "simplified  locking: allowed");
}

TEST_F(ModelSummary, NamesTheExtentWithItsTolerance) {
  expect_line({}, "in full     extent: the whole body");
  expect_line({"/dynamics/extent=local", "/dynamics/solver/kind=pcg", "/dynamics/region_tolerance=0.004"},
              "simplified  extent: only the region that moves; what is slower than 0.004 of the fastest");
}

TEST_F(ModelSummary, SaysHowMuchOfTheForceMayBeLeftOut) {
  EXPECT_EQ(describe({}).find("fidelity"), std::string::npos);
  expect_line({"/fidelity/mode=auto", "/fidelity/force_tolerance=0.05", "/fidelity/force_floor_N=0.1"},
              "simplified  fidelity: a step leaves out what moves the force by at most 5 % or 0.1 N");
}

TEST_F(ModelSummary, NamesDrainedAndUndrainedWater) {
  expect_line({}, "simplified  pore water: drained");
  const std::vector<std::string> undrained = {"/material/effective_medium/fluid_bulk_modulus_Pa=2.2e9",
                                              "/dynamics/element=p1_nodal"};
  expect_line(undrained,
              "simplified  pore water: undrained, it cannot leave a tet under pressure (K = 2.2e+09 Pa)");
  expect_line({"/water/adds_mass=false"}, "simplified  weight of the water: left out");
  EXPECT_EQ(describe({"/water/adds_mass=true"}).find("weight of the water"), std::string::npos);
}

TEST_F(ModelSummary, NamesWhatTheHandFeelsBetweenSteps) {
  expect_line({}, "in full     force: new in every tick");
  expect_line({"/preset=paper", "/haptics/frame_period_ticks=28"}, "simplified  force: held for 14 ticks");
  expect_line({"/haptics/physics_period_ticks=2", "/haptics/between_frames=compliant"},
              "simplified  force: contact every tick, with a surface that is predicted for up to 2 ticks");
  expect_line(
      {"/contact/law=pressure", "/haptics/physics_period_ticks=2", "/haptics/between_frames=compliant"},
      "simplified  force: the last answer of the clay, carried on for up to 2 ticks");
  expect_line({"/contact/vertex_face_stiffness_N_per_m=123"},
              "simplified  contact: a penalty of 123 N/m a pair");
}

TEST_F(ModelSummary, AnEquilibriumHasNoStepsAndNoTool) {
  const std::string text = describe({"/dynamics/mode=static"});
  EXPECT_NE(text.find("one elastic equilibrium"), std::string::npos) << text;
  for (const std::string words : {"hand:", "contact", "kernel", "in a step"})
    EXPECT_EQ(text.find(words), std::string::npos) << words << "\nin\n" << text;
}

TEST_F(ModelSummary, ALiveSessionsForceIsAsOldAsItsSurface) {
  const std::string text = describe_model(print_resolved(load_scenario(file, {})), file, true);
  EXPECT_NE(text.find("force: rests on the last surface that the physics had ready"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("new in every tick"), std::string::npos) << text;
  EXPECT_EQ(text.find("hand: goes where the trace goes"), std::string::npos) << text;
}

TEST_F(ModelSummary, AScenarioOfAnotherVersionSaysWhatItDoesNotSay) {
  const std::string text = describe_model(R"({"dynamics": {"model": "linear", "element": 3}})", "old.h5");
  EXPECT_NE(text.find("simplified  strain: linear"), std::string::npos) << text;
  EXPECT_NE(text.find("not said    /dynamics/element\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  ARGIL_EXPECT_THROW_WITH(describe_model("{", "old.h5"), InputError, "old.h5");
}

}  // namespace
}  // namespace argil::scenario
