// Studies on scenes with a known answer: charts whose slope is the scheme's order, maps whose boundary is the
// explicit limit, and each way to end called by its name.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "output/result_reader.h"
#include "run/run.h"
#include "scenario/build.h"
#include "scenario/scenario_text.h"
#include "solid/body.h"
#include "solid/element.h"
#include "study/chart.h"
#include "study/stability.h"
#include "study_scene.h"

namespace argil::study {
namespace {

/// ω_max of the box at E = 1 Pa, from element stiffnesses and lumped masses by a dense eigensolver.
double compute_largest_frequency(const std::string& file, double E) {
  scenario::Scenario s = scenario::load_scenario(file, {});
  const scenario::Scene scene = scenario::build_scene(s);
  const mesh::TetMesh& mesh = scene.body.mesh;
  const solid::Body solid(mesh, scene.body.topology, scene.body.supports, s.params.solid, 1);
  const double nu = 0.3;
  const Mat6 C = solid::make_isotropic_stiffness(E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)));
  const Eigen::Index n = mesh.num_vertices();
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (int t = 0; t < mesh.num_tets(); ++t) {
    solid::Mat34 rest;
    for (int i = 0; i < 4; ++i) rest.col(i) = mesh.vertices.col(mesh.tets(i, t));
    const solid::Mat12 k =
        solid::compute_element_stiffness(solid::make_tet_geometry(rest), Mat3::Identity(), C);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        K.block<3, 3>(3 * mesh.tets(i, t), 3 * mesh.tets(j, t)) += k.block<3, 3>(3 * i, 3 * j);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool is_held = mesh.vertices(2, i) < 1e-9;
    const double scale = is_held ? 0.0 : 1.0 / std::sqrt(solid.materials.mass()(i));
    K.middleRows<3>(3 * i) *= scale;
    K.middleCols<3>(3 * i) *= scale;
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues()(3 * n - 1));
}

TEST_F(Study, MapFindsTheExplicitLimitWithinOnePercent) {
  // Symplectic Euler is stable for h ω_max < 2; ω_max goes with √E.
  const double h = 1e-3;
  const double unit = compute_largest_frequency(folder / "scene.json", 1.0);
  const double limit = 4.0 / (h * h * unit * unit);
  ASSERT_EQ(map_stability(options(R"({"about": "explicit limit", "scenario": "scene.json",
    "settings": {"/dynamics/integrator": "symplectic_euler", "/dynamics/model": "linear",
      "/dynamics/rayleigh_stiffness_s": 0, "/dynamics/implicit_contact": false,
      "/contact/vertex_face_stiffness_N_per_m": 1, "/contact/edge_edge_stiffness_N_per_m": 1},
    "x": {"name": "E [Pa]", "pointers": ["/material/youngs_modulus_Pa"], "logarithmic": true,
          "values": [1e3, 1e6]}, "bisect_to": 0.01, "limits": [{"name": "theory", "x": [7]}]})"),
                          folder / "failures"),
            run::kDone);
  int boundaries = 0;
  for (const Row& row : table()) {
    if (row.at("kind") == "limit") {
      EXPECT_EQ(row.at("x") + row.at("outcome"), "7theory");
    }
    if (row.at("kind") != "boundary") continue;
    ++boundaries;
    EXPECT_EQ(row.at("outcome"), "accurate > growing_energy");
    EXPECT_NEAR(std::stod(row.at("x")), limit, 0.01 * limit);
    EXPECT_LE(std::stod(row.at("x_above")), 1.01 * std::stod(row.at("x_below")));
  }
  EXPECT_EQ(boundaries, 1);
  // What failed next to it can be run again, by itself, to the same end.
  run::RunOptions again;
  again.quiet = true;
  again.scenario = folder / "failures/study_growing_energy.json";
  again.output = folder / "again.h5";
  EXPECT_EQ(run::run(again), run::kRunFailed);
}

// Four-node tets are refused from ν = 0.45 on; before, the force is more and more another than that at 0.3.
TEST_F(Study, MapFindsBothBoundariesBetweenThreeOutcomes) {
  ASSERT_EQ(map_stability(options(R"({"about": "ν", "scenario": "scene.json",
    "x": {"name": "ν", "pointers": ["/material/poissons_ratio"], "values": [0.3, 0.7]},
    "reference": {"/material/poissons_ratio": 0.3}, "wrong_above": 0.01, "bisect_to": 0.02})"),
                          ""),
            run::kDone);
  std::vector<Row> boundaries;
  for (const Row& row : table())
    if (row.at("kind") == "boundary") boundaries.push_back(row);
  ASSERT_EQ(boundaries.size(), 2U);
  EXPECT_EQ(boundaries[0].at("outcome"), "accurate > wrong");
  EXPECT_EQ(boundaries[1].at("outcome"), "wrong > refused");
  EXPECT_LE(std::stod(boundaries[1].at("x_below")), 0.45);
  EXPECT_NEAR(std::stod(boundaries[1].at("x_above")), 0.45, 0.01);
}

TEST_F(Study, MapDoesNotTakeGravityForEnergyFromNowhere) {
  ASSERT_EQ(map_stability(options(R"({"about": "weight", "scenario": "scene.json",
    "settings": {"/body/loads/gravity_m_per_s2": [0, 0, -30]},
    "x": {"name": "E [Pa]", "pointers": ["/material/youngs_modulus_Pa"], "values": [2e4, 4e4]}})"),
                          ""),
            run::kDone);
  for (const Row& row : table()) {
    EXPECT_EQ(row.at("outcome"), "accurate");
    EXPECT_EQ(row.at("energy_gain"), "");
  }
}

TEST_F(Study, MapSaysOfAPlaceThatItCannotBeCompared) {
  ASSERT_EQ(map_stability(options(R"({"about": "ticks that the reference has not", "scenario": "scene.json",
    "x": {"name": "tick [s]", "pointers": ["/haptics/period_s"], "values": [0.001, 0.0015]},
    "reference": {"/haptics/period_s": 0.001}})"),
                          ""),
            run::kRunFailed);
  ASSERT_EQ(table().size(), 2U);
  EXPECT_EQ(table()[0].at("outcome"), "accurate");
  EXPECT_EQ(table()[1].at("outcome"), "unknown");
  EXPECT_NE(table()[1].at("reason").find("has ticks that"), std::string::npos) << table()[1].at("reason");
}

TEST_F(Study, MapSaysTheReferencesForceBesideARunsOwn) {
  ASSERT_EQ(map_stability(options(R"({"about": "softer", "scenario": "scene.json",
    "x": {"name": "E [Pa]", "pointers": ["/material/youngs_modulus_Pa"], "values": [1e4, 2e4]},
    "reference": {"/material/youngs_modulus_Pa": 2e4}, "wrong_above": 10})"),
                          ""),
            run::kDone);
  const std::vector<Row> rows = table();
  ASSERT_EQ(rows.size(), 2U);
  for (const Row& row : rows) EXPECT_EQ(row.at("reference_peak_force_N"), rows[1].at("peak_force_N"));
  EXPECT_LT(std::stod(rows[0].at("peak_force_N")), 0.95 * std::stod(rows[1].at("peak_force_N")));
  EXPECT_NE(read_text(folder / "table.csv").find("# reference: /material/youngs_modulus_Pa=2"),
            std::string::npos);
}

const std::string kChart = R"({"about": "orders", "scenario": "scene.json",
  "settings": {"/dynamics/iteration": "newton", "/dynamics/solver/kind": "cholesky"},
  "reference": {"/haptics/period_s": 0.000125, "/haptics/frame_period_ticks": 400, "/haptics/water_period_ticks": 80},
  "refined": {"/haptics/period_s": 0.0000625, "/haptics/frame_period_ticks": 800, "/haptics/water_period_ticks": 160},
  "repeats": 2,
  "curves": [{"name": "euler", "along": {"/haptics/period_s": [0.001, 0.002, 0.004]}},
             {"name": "refused", "settings": {"/material/poissons_ratio": 0.7}},
             {"name": "ended", "settings": {"/dynamics/newton/max_iterations": 1, "/dynamics/newton/tolerance": 1e-14}}]})";

TEST_F(Study, ChartHasTheOrderOfTheSchemeAndNamesWhatFailed) {
  ASSERT_EQ(chart(options(kChart)), run::kDone);
  const std::vector<Row> rows = table();
  ASSERT_EQ(rows.size(), 7U);
  const auto error = [&](std::size_t i) { return std::stod(rows[i].at("force_error")); };
  // Backward Euler, with the mean force of a tick: first order.
  EXPECT_NEAR(std::log2(error(3) / error(2)), 1.0, 0.2) << error(2) << " " << error(3);
  EXPECT_NEAR(std::log2(error(4) / error(3)), 1.0, 0.2) << error(4);
  EXPECT_LT(error(0), 0.2 * error(2));  // the reference's own
  EXPECT_EQ(rows[2].at("outcome"), "accurate");
  EXPECT_GT(std::stod(rows[2].at("cpu_s_per_s")), 0.0);
  EXPECT_EQ(std::stod(rows[3].at("steps")), 200.0);
  EXPECT_EQ(rows[5].at("outcome"), "refused");
  EXPECT_EQ(rows[5].at("reason").find("scene.json: /material/poissons_ratio"),
            0U);  // no folder of this machine
  EXPECT_EQ(rows[6].at("outcome"), "not_converged");
  EXPECT_EQ(rows[6].at("force_error"), "");
}

TEST_F(Study, ChartTakenUpAgainIsTheSame) {
  ASSERT_EQ(chart(options(kChart)), run::kDone);
  const std::string first = read_text(folder / "table.csv");
  // One run is lost, as when the study was stopped before it ended: its bits are the same, its cost is not.
  const std::string lost = table()[2].at("run");
  for (const char* suffix : {".h5", ".case"})
    ASSERT_TRUE(std::filesystem::remove(folder / ("table.runs/" + lost + suffix)));
  const auto written =
      std::filesystem::last_write_time(folder / ("table.runs/" + table()[3].at("run") + ".h5"));
  ASSERT_EQ(chart(options(kChart)), run::kDone);
  EXPECT_EQ(std::filesystem::last_write_time(folder / ("table.runs/" + table()[3].at("run") + ".h5")),
            written);
  std::istringstream a(first), b(read_text(folder / "table.csv"));
  for (std::string x, y; std::getline(a, x) && std::getline(b, y);)
    if (x.find(lost) == std::string::npos) {
      EXPECT_EQ(x, y);
    }
  EXPECT_EQ(table()[2].at("force_error"), read_table(folder / "table.csv")[2].at("force_error"));
}

TEST_F(Study, BudgetPrintsThePatchOfTheMostAccurateRunThatFits) {
  testing::internal::CaptureStdout();
  ASSERT_EQ(chart_budget(options(kChart), 1e6), run::kDone);
  const std::string patch = testing::internal::GetCapturedStdout();
  EXPECT_NE(patch.find(R"("period_s": 0.001)"), std::string::npos) << patch;
  EXPECT_NE(patch.find(R"("iteration": "newton")"), std::string::npos) << patch;
  EXPECT_EQ(chart_budget(options(kChart), 1e-9), run::kRunFailed);
}

// A run to an accuracy is made in passes, on cells and elements of its own. What it costs is all of them; how
// far off it is, is what the same cells given by hand are off.
TEST_F(Study, ChartCountsAllPassesOfARunToAnAccuracyAndComparesWhatItMade) {
  const auto make = [&](const std::string& curve) {
    return options(R"({"about": "asked", "scenario": "scene.json",
      "settings": {"/contact/law": "pressure", "/haptics/frame_period_ticks": 40},
      "reference": {"/dynamics/element": "p2", "/body/shape/target_tets": 600},
      "refined": {"/body/shape/target_tets": 900}, "repeats": 1, "curves": [)" +
                   curve + "]}");
  };
  ASSERT_EQ(chart(make(R"({"name": "asked", "settings": {"/fidelity/accuracy": 0.2}})")), run::kDone);
  const Row asked = table().at(2);
  ASSERT_EQ(asked.at("reason"), "");
  const output::ResultReader reader(folder / ("table.runs/" + asked.at("run") + ".h5"));
  std::map<std::string, double> timing;
  for (const auto& [name, seconds] : reader.read_timing()) timing[name] = seconds;
  EXPECT_GT(timing.at("cpu_of_passes"), 0.1 * timing.at("cpu"));
  EXPECT_LT(timing.at("cpu_of_passes"), 10.0 * timing.at("cpu"));
  EXPECT_NEAR(std::stod(asked.at("cpu_s_per_s")) * std::stod(asked.at("simulated_s")),
              timing.at("cpu") + timing.at("cpu_of_passes"), 1e-6);
  const scenario::Scenario made =
      scenario::load_text(reader.find_provenance("scenario").value(), folder / "scene.json", {});
  std::ostringstream by_hand;
  by_hand.precision(17);
  by_hand << R"({"name": "by hand", "settings": {"/dynamics/element": "p2", "/body/cells/kind": "graded",)"
          << R"("/body/cells/near_tool_m": )" << made.body.cells.near_tool
          << R"(, "/body/shape/target_tets": )" << made.body.target_tets
          << R"(, "/haptics/physics_period_ticks": )" << made.params.rates.physics_period_ticks << "}}";
  ASSERT_EQ(chart(make(by_hand.str())), run::kDone);
  for (const char* column : {"force_error", "displacement_error", "steps"})
    EXPECT_EQ(table().at(2).at(column), asked.at(column)) << column;
  EXPECT_GT(std::stod(asked.at("displacement_error")), 0.0);
}

TEST_F(Study, MapNamesEachWayToEnd) {
  const auto outcome = [&](const std::string& study) {
    EXPECT_EQ(map_stability(options(study), ""), run::kDone);
    return table().at(0).at("outcome");
  };
  EXPECT_EQ(outcome(one_place("", "/material/poissons_ratio", "0.3")), "accurate");
  EXPECT_EQ(
      outcome(one_place("", "/dynamics/min_volume_ratio", "0.999", R"("/dynamics/min_volume_ratio": 0)")),
      "inverted");
  EXPECT_EQ(
      outcome(one_place(R"("/dynamics/solver/kind": "pcg_jacobi", "/dynamics/solver/tolerance": 1e-12)",
                        "/dynamics/solver/max_iterations", "1", R"("/dynamics/solver/max_iterations": 500)")),
      "not_converged");
  // Twice as stiff clay is felt as more than a tenth.
  EXPECT_EQ(
      outcome(one_place("", "/material/youngs_modulus_Pa", "2e4", R"("/material/youngs_modulus_Pa": 4e4)")),
      "wrong");
  // A stiff contact whose force is held for longer than the clay takes to give way.
  EXPECT_EQ(
      outcome(one_place(
          R"("/haptics/physics_period_ticks": 10, "/haptics/frame_period_ticks": 50, "/contact/edge_edge_stiffness_N_per_m": 2000)",
          "/contact/vertex_face_stiffness_N_per_m", "2000",
          R"("/dynamics/implicit_contact": true, "/haptics/physics_period_ticks": 1)",
          R"("/dynamics/implicit_contact": false, )")),
      "chatter");
}

TEST_F(Study, MapWithoutATruthSaysSo) {
  // The reference is refused, or the tool never comes near: nothing is accurate then.
  for (const auto& [reference, reason] :
       {std::pair(R"("/material/poissons_ratio": 0.7)", "reference: scene.json: /material/poissons_ratio"),
        std::pair(R"("/trace/device_to_world/translation_m": [1, 0, 0])", "")}) {
    EXPECT_EQ(map_stability(options(one_place("", "/material/density_kg_per_m3", "1500", reference)), ""),
              run::kRunFailed);
    EXPECT_EQ(table().at(0).at("outcome"), "unknown");
    EXPECT_EQ(table().at(0).at("reason").find(reason), 0U) << table().at(0).at("reason");
  }
}

TEST_F(Study, RunThatWasKilledOrDamagedIsRunAgain) {
  const std::string study = one_place("", "/material/poissons_ratio", "0.3");
  StudyOptions o = options(study);
  // The first run of the program kills itself.
  o.cases.program = test::write_text(
      folder / "argil.sh", "#!/bin/sh\nif mkdir '" + (folder / "killed") +
                               "' 2>/dev/null; then kill -9 $$; fi\nexec '" ARGIL_BINARY "' \"$@\"\n");
  std::filesystem::permissions(o.cases.program, std::filesystem::perms::owner_all);
  o.cases.jobs = 1;
  EXPECT_EQ(map_stability(o, ""), run::kRunFailed);
  EXPECT_EQ(table().at(0).at("outcome"), "killed");
  EXPECT_EQ(map_stability(o, ""), run::kDone);
  EXPECT_EQ(table().at(0).at("outcome"), "accurate");
  const std::string whole = read_text(folder / "table.csv");
  const std::string kept = folder / ("table.runs/" + table().at(0).at("run") + ".h5");
  std::filesystem::resize_file(kept, std::filesystem::file_size(kept) / 2);
  EXPECT_EQ(map_stability(o, ""), run::kDone);
  EXPECT_EQ(read_text(folder / "table.csv"), whole);
}

}  // namespace
}  // namespace argil::study
