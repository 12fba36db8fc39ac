// /dynamics/mode "static": one equilibrium without tool and trace. Closed forms of elastostatics (Hooke's
// law; a column under its own weight), bodies that only supports move, what is refused, and what a failed run
// leaves.
#include <gtest/gtest.h>

#include "output/result_reader.h"
#include "refusal.h"

namespace argil {
namespace {

constexpr double kYoungsModulus = 1e5;  // [Pa]
constexpr double kEdge = 0.1;           // of the box, which stands on z = 0 with its axis at x = y = 0 [m]
constexpr double kRounding = 1e-10;     // of the largest; Newton's tolerance

/// A box with these supports and loads, and more keys of "dynamics", each with a comma before it.
std::string make_box(const std::string& fixed, const std::string& loads, const std::string& dynamics = "") {
  return R"({"about": "a box in equilibrium", "body": {
    "shape": {"kind": "box", "size_m": 0.1, "target_tets": 150, "skin_triangles": 0},
    "fixed": [)" +
         fixed + R"(], "loads": {)" + loads +
         R"(}}, "material": {"youngs_modulus_Pa": 1e5, "density_kg_per_m3": 1500, "poissons_ratio": 0.3},
  "dynamics": {"mode": "static")" +
         dynamics + "}}";
}

std::string hold_plane(const std::string& normal, double offset, const std::string& fixes) {
  return R"({"kind": "plane", "normal": )" + normal + R"(, "offset_m": )" + std::to_string(offset) + fixes +
         "}";
}

const std::string kFloor = hold_plane("[0, 0, 1]", 0.0, "");
const std::string kLift =
    R"("pressure": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0.1, "pressure_Pa": -2000}])";

class StaticMode : public testing::Test {
 protected:
  test::TempFolder folder;

  int run(const std::string& scenario) const {
    return run_path(test::write_text(folder / "scene.json", scenario), {});
  }
  int run_file(const std::string& name, const std::vector<std::string>& settings = {}) const {
    return run_path(std::string(ARGIL_SOURCE_DIR) + "/scenarios/" + name, settings);
  }
  int run_path(const std::string& path, const std::vector<std::string>& settings) const {
    run::RunOptions options;
    options.quiet = true;
    options.scenario = path;
    options.settings = settings;
    options.output = folder / "out.h5";
    return run::run(options);
  }
  output::ResultReader result() const { return output::ResultReader(folder / "out.h5"); }
  Points rest() const { return result().read_header().rest_position; }
  Points displacement() const {
    const output::ResultReader file = result();
    return file.read_frame(file.read_frame_list().at(0)).position - file.read_header().rest_position;
  }
  void expect_refused(const std::string& scenario, const std::vector<std::string>& parts) const {
    test::expect_refused(folder, scenario, {}, parts);
  }
};

void expect_near(const Points& u, const Points& expected) {
  EXPECT_LE((u - expected).cwiseAbs().maxCoeff(), kRounding * expected.cwiseAbs().maxCoeff());
}

class StaticElement : public StaticMode, public testing::WithParamInterface<const char*> {};

TEST_P(StaticElement, PulledBoxStretchesByHookesLaw) {
  // u = p/E (−ν x', −ν y', z) with p = 2 kPa, from the corner of the three sides that it slides on.
  const std::string element = GetParam();
  ASSERT_EQ(run_file("verify_static_pull.json", {"/dynamics/element=" + element}), run::kDone);
  Points expected = 2000.0 / kYoungsModulus * rest();
  expected.row(0) = -0.3 * (expected.row(0).array() + 2000.0 / kYoungsModulus * 0.5 * kEdge);
  expected.row(1) = -0.3 * (expected.row(1).array() + 2000.0 / kYoungsModulus * 0.5 * kEdge);
  expect_near(displacement(), expected);
}

INSTANTIATE_TEST_SUITE_P(EveryElement, StaticElement, testing::Values("p1", "p1_nodal", "p2"));

TEST_F(StaticMode, QuadraticColumnUnderItsOwnWeightIsExact) {
  // ν = 0: u_z = −ρ g (H z − z²/2)/E. The solution is in the space of p2, so its vertices are exact.
  ASSERT_EQ(run_file("verify_static_column.json"), run::kDone);
  const auto z = rest().row(2).array().eval();
  Points expected = Points::Zero(3, z.size());
  expected.row(2) = -1500.0 * 10.0 / kYoungsModulus * (kEdge * z - 0.5 * z.square());
  expect_near(displacement(), expected);
}

class StaticModel : public StaticMode, public testing::WithParamInterface<const char*> {};

TEST_P(StaticModel, BodyWithoutLoadsIsAtRest) {
  ASSERT_EQ(run(make_box(kFloor, "", std::string(R"(, "model": ")") + GetParam() + '"')), run::kDone);
  EXPECT_LE(displacement().cwiseAbs().maxCoeff(), 1e-14 * kEdge);
}

TEST_P(StaticModel, ShiftedSupportTakesTheBodyAlong) {
  const std::string shifted = hold_plane("[0, 0, 1]", 0.0, R"(, "displacement_m": [0.04, 0, -0.03])");
  ASSERT_EQ(run(make_box(shifted, "", std::string(R"(, "model": ")") + GetParam() + '"')), run::kDone);
  const Points u = displacement();
  expect_near(u, Vec3(0.04, 0.0, -0.03).replicate(1, u.cols()));
}

INSTANTIATE_TEST_SUITE_P(EveryModel, StaticModel,
                         testing::Values("linear", "corotational", "neo_hookean", "hencky"));

TEST_F(StaticMode, SupportsThatLeaveAShiftAreRefused) {
  expect_refused(make_box(hold_plane("[0, 0, 1]", 0.0, R"(, "fixes_x": false)"), ""),
                 {"scene.json", "/body/fixed", "can shift along (1, 0, 0)", "at least three vertices"});
}

TEST_F(StaticMode, SupportsOnALineLeaveATurnAndAreRefused) {
  // The box's upright edge at x = y = −0.05.
  const std::string edge =
      R"({"kind": "box", "lower_m": [-0.051, -0.051, -1], "upper_m": [-0.049, -0.049, 1]})";
  expect_refused(make_box(edge, ""),
                 {"/body/fixed", "can turn about an axis along (0, 0, ", "not on a line"});
}

TEST_F(StaticMode, NormalWithoutLengthIsRefused) {
  expect_refused(make_box(hold_plane("[0, 0, 0]", 0.0, ""), ""), {"/body/fixed/0/normal", "has no length"});
}

TEST_F(StaticMode, NoSupportsAreRefused) {
  expect_refused(make_box("", kLift), {"/body/fixed", "does not hold the body"});
}

TEST_F(StaticMode, PressureRegionWithoutAFaceIsRefused) {
  expect_refused(
      make_box(kFloor, R"("pressure": [{"kind": "sphere", "centre_m": [0, 0, 0.05], "radius_m": 0.02,
                                                   "pressure_Pa": 1}])"),
      {"/body/loads/pressure/0", "no boundary face", "all three corners"});
}

TEST_F(StaticMode, UnknownVerticesAreRefusedByNumberWithTheirRange) {
  expect_refused(make_box(kFloor, R"("nodal": [{"nodes": [3], "force_N": [0, 0, 1]},
                                               {"nodes": [0, 99999], "force_N": [0, 0, 1]}])"),
                 {"/body/loads/nodal/1/nodes", "99999", "from 0 to "});
  expect_refused(make_box(R"({"kind": "nodes", "nodes": [0, 88888]})", ""),
                 {"/body/fixed/0/nodes", "88888", "from 0 to "});
}

TEST_F(StaticMode, FailureLeavesAReadableFileWithTheLastGoodState) {
  ASSERT_EQ(run(make_box(kFloor, kLift, R"(, "newton": {"max_iterations": 1})")), run::kRunFailed);
  EXPECT_EQ(result().outcome(), output::Outcome::failed);
  EXPECT_EQ(result().read_failure()->stage, "solid");
  EXPECT_NE(result().read_failure()->quantity.find("Newton"), std::string::npos);
  EXPECT_EQ(displacement(), Points::Zero(3, rest().cols()));  // no share of the load converged
  EXPECT_LE(result().read_physics().at(0).elastic_energy, 1e-20);
}

TEST_F(StaticMode, ShowGivesTheSceneBackWithoutToolAndTrace) {
  run::RunOptions options;
  options.scenario = test::write_text(folder / "scene.json", make_box(kFloor, kLift));
  const std::string shown = scenario::print_resolved(run::load(options));
  for (const char* key : {"\"tool\"", "\"contact\"", "\"haptics\"", "\"trace\""})
    EXPECT_EQ(shown.find(key), std::string::npos) << key;
  options.scenario = test::write_text(folder / "shown.json", shown);
  EXPECT_EQ(scenario::print_resolved(run::load(options)), shown);
}

TEST_F(StaticMode, MotionStillNeedsATraceAndPairsTheirStiffness) {
  std::string moving = make_box(kFloor, kLift);
  moving.replace(moving.find("static"), 6, "dynamic");
  expect_refused(moving, {"/trace/file", "is missing"});
  moving.insert(moving.rfind('}'), R"(, "contact": {"law": "pairs"})");
  expect_refused(moving, {"/contact/vertex_face_stiffness_N_per_m", "is missing"});
}

}  // namespace
}  // namespace argil
