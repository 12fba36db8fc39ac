// What a run refuses, and the one line it says: file, place, value, remedy. Nothing is written.
#include <gtest/gtest.h>

#include "refusal.h"
#include "support/scene_files.h"

namespace argil {
namespace {

class BadInput : public testing::Test {
 protected:
  test::TempFolder folder;
  std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");

  void expect_refused(const std::string& scenario, const std::vector<std::string>& settings,
                      const std::vector<std::string>& parts) const {
    test::expect_refused(folder, scenario, settings, parts);
  }
  std::string ball() const { return test::make_ball_scenario(trace); }
  /// The ball's scenario with another body.
  std::string with_body(const std::string& body) const {
    std::string text = ball();
    const std::string from =
        R"("shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0})";
    return text.replace(text.find(from), from.size(), body);
  }
};

TEST_F(BadInput, MissingScenarioIsNamed) {
  run::RunOptions options;
  options.scenario = folder / "nowhere.json";
  try {
    run::run(options);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.json"), std::string::npos) << error.what();
  }
}

TEST_F(BadInput, MissingTraceIsNamedWithItsPointer) {
  expect_refused(test::make_ball_scenario("gone.csv"), {}, {"/trace/file", "gone.csv", "does not exist"});
}

TEST_F(BadInput, UnknownKeyNamesTheNearest) {
  expect_refused(ball(), {"/material/youngs_modulus=1e5"},
                 {"/material/youngs_modulus", "not a known key", "youngs_modulus_Pa"});
}

TEST_F(BadInput, ValueOutsideItsRangeNamesRangeAndUnit) {
  expect_refused(ball(), {"/material/youngs_modulus_Pa=-3"},
                 {"/material/youngs_modulus_Pa", "-3", "[1e-09, 1e+18] Pa"});
  expect_refused(ball(), {"/material/poissons_ratio=0.5"},
                 {"/material/poissons_ratio", "0.5", "(-1.0, 0.5)"});
}

TEST_F(BadInput, WrongTypeIsNamed) {
  expect_refused(ball(), {"/haptics/physics_period_ticks=1.5"},
                 {"/haptics/physics_period_ticks", "1.5", "whole number"});
  expect_refused(ball(), {"/material/density_kg_per_m3=heavy"},
                 {"/material/density_kg_per_m3", "heavy", "kg/m³"});
}

TEST_F(BadInput, DuplicateKeyIsRefused) {
  std::string text = ball();
  text.insert(text.rfind('}'), ", \"about\": \"again\"");
  expect_refused(text, {}, {"scene.json: /about: stands twice"});
}

TEST_F(BadInput, BrokenJsonNamesLineAndColumn) {
  expect_refused("{\n  \"about\": }", {}, {"line 2, column 12"});
}

TEST_F(BadInput, NanInTheTraceIsNamedWithItsLine) {
  const std::string bad =
      test::write_text(folder / "bad.csv", "t,x,y,z\n0,0,0,0.05\n0.001,0,nan,0.05\n0.002,0,0,0.05\n");
  expect_refused(test::make_ball_scenario(bad), {}, {"bad.csv", "line 3", "nan"});
}

TEST_F(BadInput, UnsortedTimeIsNamedWithItsLine) {
  const std::string bad = test::write_text(
      folder / "bad.csv", "t,x,y,z\n0,0,0,0.05\n0.002,0,0,0.05\n0.001,0,0,0.05\n0.003,0,0,0.05\n");
  expect_refused(test::make_ball_scenario(bad), {}, {"bad.csv", "line 4"});
}

TEST_F(BadInput, InvertedTetIsNamedByItsNumber) {
  test::write_text(
      folder / "bad.mesh",
      "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 0\n0.02 0 0 0\n0 0.02 0 0\n0 0 0.02 0\n"
      "0 0 -0.02 0\nTetrahedra 2\n1 2 3 4 0\n1 2 3 5 0\nEnd\n");
  expect_refused(with_body(R"("mesh": {"file": "bad.mesh"})"), {},
                 {"bad.mesh", "1 of 2 have negative volume: 1"});
}

TEST_F(BadInput, CageThatLeavesSkinVerticesOutsideIsRefusedWithTheirNumber) {
  test::write_text(folder / "cage.mesh",
                   "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n0.02 0 0 0\n0 0.02 0 0\n"
                   "0 0 0.02 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n");
  test::write_text(folder / "skin.obj",
                   "v 0.001 0.001 0.001\nv 0.01 0.001 0.001\nv 0.001 0.01 0.001\nv 0.001 0.001 0.03\n"
                   "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  expect_refused(with_body(R"("surface": {"file": "skin.obj", "cage": "cage.mesh"})"), {},
                 {"cage.mesh", "1 of 4", "outside", "3"});
}

TEST_F(BadInput, SkinThatIsOpenIsRefusedWhereItIsTouched) {
  test::write_text(folder / "open.obj",
                   "v 0 0 0\nv 0.03 0 0\nv 0 0.03 0\nv 0 0 0.03\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  expect_refused(with_body(R"("surface": {"file": "open.obj", "target_tets": 1000})"),
                 {"/contact/law=pressure"}, {"/contact/surface", "open.obj", "open", "set \"cage\""});
}

TEST_F(BadInput, NumberOfTetsThatAShapeCannotHaveIsRefusedWithItsPointer) {
  expect_refused(ball(), {"/body/shape/target_tets=400"},
                 {"scene.json: /body/shape: target_tets 400", "15 %", "ask for"});
}

TEST_F(BadInput, ToolThatStartsInsideTheBodyIsRefused) {
  const std::string deep = test::write_press_trace(folder / "deep.csv", 0.020, 0.019, 0.1, "push");
  expect_refused(
      test::make_ball_scenario(deep), {},
      {"scene.json: /trace", "starts in or across the body", "with the hand at (0.001, 0.0007, 0.02) m"});
}

TEST_F(BadInput, MotionThatStartsInsideSaysHowDeepAndInWhichFile) {
  // Ball of radius 20 mm, tool of 6 mm with its centre 1.22 mm off the ball's: the tool's point that is
  // nearest to the centre lies 20 − (6 − 1.22) = 15.2 mm deep, less what the facets of both cut off. The
  // trace was given beside the scenario.
  run::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "scene.json", ball());
  options.trace = test::write_press_trace(folder / "deep.csv", 0.020, 0.019, 0.1, "push");
  try {
    run::run(options);
    FAIL() << "was not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    const std::string words = "deep.csv: the tool starts in or across the body, ";
    const std::size_t at = text.find(words);
    ASSERT_NE(at, std::string::npos) << text;
    const double depth = std::stod(text.substr(at + words.size()));
    EXPECT_LT(depth, 15.3);
    EXPECT_GT(depth, 14.3);
  }
}

TEST_F(BadInput, FolderInPlaceOfAFileIsRefused) {
  std::filesystem::create_directory(folder / "motion.csv");
  expect_refused(test::make_ball_scenario("motion.csv"), {},
                 {"motion.csv: /trace/file: is a folder; name a file"});
}

TEST_F(BadInput, DeviceThatNeverEndsIsRefused) {
  expect_refused(test::make_ball_scenario("/dev/zero"), {},
                 {"/dev/zero: /trace/file: is a device; name a file"});
}

TEST_F(BadInput, FixedRegionWithoutVerticesIsRefused) {
  expect_refused(ball(), {R"(/body/fixed=[{"kind":"sphere","centre_m":[1,1,1],"radius_m":0.1}])"},
                 {"/body/fixed/0", "holds no vertex", "body's box, (-0.0", ", 0) to (0.0", ", 0.04) m"});
}

TEST_F(BadInput, DilutePaperLawPastItsPoleIsRefusedWithPhiModeAndRemedy) {
  // Undrained water in ν = 0.3 clay: the paper's bulk modulus turns negative past φ = α + K_M/(K_I − K_M),
  // 0.619.
  expect_refused(ball(),
                 {"/material/effective_medium/scheme=dilute",
                  "/material/effective_medium/fluid_bulk_modulus_Pa=2.2e9", "/water/porosity=0.7"},
                 {"/material/effective_medium/scheme", "bulk", "0.619", "mori_tanaka"});
}

TEST_F(BadInput, SchemeThatAlignedSpheroidsDoNotAllowIsNamed) {
  expect_refused(ball(),
                 {"/material/effective_medium/scheme=differential", "/material/effective_medium/aspect=0.2",
                  "/material/effective_medium/orientation=aligned"},
                 {"/material/effective_medium/scheme: differential needs an isotropic medium"});
}

TEST_F(BadInput, UsersTableIsRefusedWithTheValueAtFault) {
  const auto refuse = [&](const std::string& S, const std::vector<std::string>& parts) {
    expect_refused(ball(),
                   {"/material/moisture/law=table", "/material/moisture/table_saturation=" + S,
                    "/material/moisture/table_youngs_modulus_Pa=[1e5, 5e4, 1e4]",
                    "/material/moisture/table_yield=[0.02, 0.02, 0.02]"},
                   parts);
  };
  refuse("[]", {"/table_saturation: is empty", "law is table", "[0, 1]"});
  refuse("[0.1, 0.5, 1]", {"/table_saturation: begins with 0.1"});
  refuse("[0, 0.5, 0.9]", {"/table_saturation: ends with 0.9"});
  refuse("[0, 0.5, 0.5, 1]", {"/table_saturation/2: 0.5 is not above the 0.5"});
  refuse("[0, 1]", {"has 2 values, table_youngs_modulus_Pa 3"});
}

TEST_F(BadInput, SurfaceThatYieldsBetweenFramesIsRefusedWithoutAnImplicitStep) {
  expect_refused(
      ball(), {"/preset=paper", "/haptics/between_frames=compliant", "/dynamics/integrator=symplectic_euler"},
      {"/haptics/between_frames", "symplectic_euler", "re_evaluate"});
  expect_refused(ball(),
                 {"/preset=paper", "/haptics/between_frames=compliant", "/dynamics/implicit_contact=false"},
                 {"/haptics/between_frames", "implicit_contact"});
  expect_refused(ball(), {"/haptics/between_frames=compliance"}, {"/haptics/between_frames", "compliant"});
  expect_refused(ball(), {"/haptics/passivity=1"}, {"/haptics/passivity", "time_domain"});
}

TEST_F(BadInput, TouchedSurfaceThatTheBodyLacksIsRefused) {
  expect_refused(ball(), {"/contact/surface=skin"},
                 {"/contact/surface", "the body has none", "skin_triangles", "cage"});
  expect_refused(ball(), {"/contact/surface=skins"}, {"/contact/surface", "skins", "cage", "skin"});
  expect_refused(ball(), {"/contact/minimum_separation_m=-1e-6"},
                 {"/contact/minimum_separation_m", "-1e-06", "[0.0, ∞) m"});
}

TEST_F(BadInput, LockingTetsAreRefusedUnlessAllowed) {
  expect_refused(ball(), {"/material/poissons_ratio=0.49"},
                 {"/material/poissons_ratio", "lock", "allow_locking"});
}

}  // namespace
}  // namespace argil
