// The effective medium of a scene over every φ that its water can reach: refused, warned of, or written down.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "hdf5/file.h"
#include "material/effective_medium.h"
#include "mesh/order.h"
#include "output/result_reader.h"
#include "refusal.h"
#include "scenario/build.h"
#include "support/block_mesh.h"

namespace argil {
namespace {

/// A ball of wet clay with pores full of water that cannot leave: a scene that the paper's law turns
/// indefinite.
class SoakedBall : public testing::Test {
 protected:
  test::TempFolder folder;

  run::RunOptions make_options(const std::vector<std::string>& settings) {
    run::RunOptions options;
    options.quiet = true;
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
    options.scenario = test::write_text(folder / "scene.json", test::make_ball_scenario(trace));
    options.output = folder / "out.h5";
    options.settings = {"/material/effective_medium/fluid_bulk_modulus_Pa=2.2e9", "/water/porosity=0.65",
                        "/body/initial_saturation=1", "/dynamics/element=p1_nodal", "/trace/duration_s=0.05"};
    options.settings.insert(options.settings.end(), settings.begin(), settings.end());
    return options;
  }
};

TEST_F(SoakedBall, OfThePapersLawIsRefusedWithPhiModeAndRemedy) {
  try {
    run::run(make_options({"/material/effective_medium/scheme=dilute"}));
    FAIL() << "was not refused";
  } catch (const InputError& error) {
    const std::string text = error.what();
    // The pole of eq. 6: φ = α + K_M/(K_I − K_M), α = 13/21 at ν = 0.3.
    for (const char* part : {"/material/effective_medium/scheme", "not positive definite", "mode \"bulk\"",
                             "phi = 0.61908", "undrained", "porosity = 0.65", "mori_tanaka", "up to 0.61"})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

TEST_F(SoakedBall, OfMoriTanakaRunsAndSaysSoInItsFile) {
  EXPECT_EQ(run::run(make_options({"/material/effective_medium/scheme=mori_tanaka"})), run::kDone);
  const hdf5::File file = hdf5::File::open_for_reading(folder / "out.h5");
  const std::string status =
      file.root().open_group("provenance").open_dataset("effective_medium").read_string();
  EXPECT_EQ(status, "effective medium (undrained): ok; checked for phi from 0 to 0.65");
}

TEST_F(SoakedBall, AboveTheVoigtBoundRunsWithAWarning) {
  // β = 2(4−5ν)/(15(1−ν)) = 10/21 at ν = 0.3: shear leaves the bound there, long before the bulk modulus.
  const scenario::Scenario s =
      run::load(make_options({"/material/effective_medium/scheme=dilute", "/water/porosity=0.5"}));
  EXPECT_NE(s.medium_status.find("above_voigt in mode \"shear\" from phi = 0.47619"), std::string::npos)
      << s.medium_status;
  ASSERT_EQ(s.warnings.size(), 1U);
  EXPECT_NE(s.warnings[0].find(s.medium_status), std::string::npos);
}

TEST_F(SoakedBall, IsAskedOnlyForTheWaterThatCanReachIt) {
  // The paper's law fails past φ = 0.619 at n = 0.65. With a uniform S at the start and a tool that gives no
  // water nothing is ever wetter than S; diffusion only evens it out.
  const std::string dilute = "/material/effective_medium/scheme=dilute";
  const std::string no_flux = "/water/wetting_flux_kg_per_m2_s=0";
  struct Case {
    std::vector<std::string> settings;
    std::string phi;
  };
  for (const Case& c : {Case{{no_flux, "/body/initial_saturation=0"}, "0"},
                        Case{{no_flux, "/body/initial_saturation=0.5"}, "0.325"},
                        Case{{"/tool/mode=push", "/body/initial_saturation=0.5"}, "0.325"},
                        Case{{"/tool/mode=dry", "/body/initial_saturation=0.5"}, "0.325"},
                        Case{{"/water/uptake=increment", "/body/initial_saturation=0.5"}, "0.325"}}) {
    std::vector<std::string> settings = c.settings;
    settings.push_back(dilute);
    EXPECT_EQ(run::load(make_options(settings)).medium_status,
              "effective medium (undrained): ok; checked for phi from 0 to " + c.phi);
  }
  const auto refuse = [&](std::vector<std::string> settings, const std::string& part) {
    settings.push_back(dilute);
    try {
      run::load(make_options(settings));
      ADD_FAILURE() << "was not refused: " << part;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refuse({"/body/initial_saturation=0"}, "reaches phi = porosity = 0.65");  // the trace may wet
  refuse({"/tool/mode=wet", "/body/initial_saturation=0"}, "reaches phi = porosity = 0.65");
  refuse({"/water/uptake=increment", "/water/saturation_increment=0.01", "/body/initial_saturation=0"},
         "reaches phi = porosity = 0.65");
  // n ≤ 0.619/0.98 = 0.6317 would do.
  refuse({no_flux, "/body/initial_saturation=0.98"}, "the wettest clay, S = 0.98, has phi = 0.637; ");
  refuse({no_flux, "/body/initial_saturation=0.98"}, "a /water/porosity up to 0.63");
}

TEST_F(SoakedBall, OfASchemeWithoutAnyStiffnessIsNotAdvisedToHaveNoPores) {
  // Drained, the lower bounds are 0 from φ = 0 on.
  for (const std::string scheme : {"hs_lower", "reuss"}) try {
      run::load(make_options({"/material/effective_medium/scheme=" + scheme,
                              "/material/effective_medium/fluid_bulk_modulus_Pa=0"}));
      ADD_FAILURE() << "was not refused";
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(scheme + " gives"), std::string::npos) << text;
      EXPECT_NE(text.find("choose mori_tanaka"), std::string::npos) << text;
      EXPECT_EQ(text.find("porosity up to"), std::string::npos) << text;
    }
}

/// A bar along x whose mesh file carries fields, pulled between six smooth walls.
class BarWithFields : public testing::Test {
 protected:
  static constexpr double kLength = 0.06;  // [m]
  test::TempFolder folder;
  mesh::TetMesh bar = test::make_block(6, 1, 1, Vec3(kLength, 0.01, 0.01));

  std::string write_scenario(const std::string& fields, const std::string& medium, const std::string& more) {
    test::write_vtk(folder / "bar.vtk", bar);
    std::string walls;
    for (const auto& [normal, offset, keys] :
         {std::tuple("[1, 0, 0]", "0", "\"fixes_y\": false, \"fixes_z\": false"),
          std::tuple("[1, 0, 0]", "0.06",
                     "\"fixes_y\": false, \"fixes_z\": false, \"displacement_m\": [0.0006, 0, 0]"),
          std::tuple("[0, 1, 0]", "0", "\"fixes_x\": false, \"fixes_z\": false"),
          std::tuple("[0, 1, 0]", "0.01", "\"fixes_x\": false, \"fixes_z\": false"),
          std::tuple("[0, 0, 1]", "0", "\"fixes_x\": false, \"fixes_y\": false"),
          std::tuple("[0, 0, 1]", "0.01", "\"fixes_x\": false, \"fixes_y\": false")})
      walls += std::string(walls.empty() ? "" : ", ") + R"({"kind": "plane", "normal": )" + normal +
               R"(, "offset_m": )" + offset + ", " + keys + "}";
    return R"({"about": "a bar with fields", "body": {"mesh": {"file": "bar.vtk")" + fields +
           R"(}, "initial_saturation": 1, "fixed": [)" + walls +
           R"(]}, "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "effective_medium": {)" +
           medium + R"(}}, "dynamics": {"mode": "static", "model": "linear"}, "water": {"porosity": 0.65})" +
           more + "}";
  }
  scenario::Scenario load(const std::string& text, const std::vector<std::string>& settings = {}) {
    run::RunOptions options;
    options.scenario = test::write_text(folder / "scene.json", text);
    options.settings = settings;
    return run::load(options);
  }
  bool is_in_first_half(int tet) const {
    return bar.vertices(0, bar.tets.col(tet).minCoeff()) < 0.5 * kLength - 1e-9;
  }
};

TEST_F(BarWithFields, TakesThePoresAxisOfEachTetFromItsThreeComponents) {
  // Any length, any direction; halves across and along the pull are springs in a row.
  const int n = bar.num_tets();
  Points axes(3, n);
  for (int t = 0; t < n; ++t) axes.col(t) = Vec3(1.0 + t, 2.0 - 0.3 * t, -0.7 * t);
  for (int k = 0; k < 3; ++k) bar.cell_fields[std::string("fibre_") + "xyz"[k]] = axes.row(k);
  const std::string fields = R"(, "pore_axis_field": "fibre")";
  const std::string flat = R"("aspect": 0.1, "orientation": "aligned")";
  const scenario::Scene scene = scenario::build_scene(load(write_scenario(fields, flat, "")));
  const Points taken = mesh::in_file_order(scene.body.mesh, scene.body.pore_axis);
  for (int t = 0; t < n; ++t) EXPECT_LT((taken.col(t) - axes.col(t) / axes.col(t).norm()).norm(), 1e-15) << t;

  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k)
      bar.cell_fields[std::string("fibre_") + "xyz"[k]](t) = k == (is_in_first_half(t) ? 0 : 1) ? 5.0 : 0.0;
  run::RunOptions options;
  options.quiet = true;
  options.scenario = test::write_text(folder / "scene.json", write_scenario(fields, flat, ""));
  options.output = folder / "out.h5";
  ASSERT_EQ(run::run(options), run::kDone);
  material::EffectiveMedium medium;
  medium.aspect = 0.1;
  medium.orientation = material::Orientation::aligned;
  const Mat6 C = material::compute_effective_medium({1e5, 0.3}, medium, 0.65).stiffness;
  const output::ResultReader result(options.output);
  const Points moved = result.read_frame(result.read_frame_list().at(0)).position - bar.vertices;
  for (Eigen::Index v = 0; v < moved.cols(); ++v) {
    if (std::abs(bar.vertices(0, v) - 0.5 * kLength) > 1e-12) continue;
    EXPECT_NEAR(moved(0, v) / 6e-4, C(0, 0) / (C(0, 0) + C(2, 2)), 1e-9);
  }
}

TEST_F(BarWithFields, AxesOfPoresThatLieAtRandomAreRefused) {
  for (const char* k : {"fibre_x", "fibre_y", "fibre_z"}) bar.cell_fields[k] = Field::Ones(bar.num_tets());
  const std::string fields = R"(, "pore_axis_field": "fibre")";
  test::expect_refused(folder, write_scenario(fields, R"("aspect": 0.1)", ""), {},
                       {"/body/mesh/pore_axis_field", "\"fibre\" has no effect", "random", "aligned"});
  const scenario::Scenario spheres = load(write_scenario(fields, R"("orientation": "aligned")", ""));
  ASSERT_EQ(spheres.warnings.size(), 1U);
  EXPECT_NE(spheres.warnings[0].find("isotropic"), std::string::npos);
}

TEST_F(BarWithFields, IsAskedWhereEqSixEndsForItsSoftestClay) {
  // K_I = 1 MPa: eq. 6 ends at φ = α + K_M/(K_I − K_M), 0.7100 for E = 100 kPa and 0.62745 for 10 kPa.
  const std::string paper = R"("scheme": "dilute", "fluid_bulk_modulus_Pa": 1e6)";
  const std::string fields = R"(, "youngs_modulus_field": "E")";
  const std::vector<std::string> p1_nodal = {"/dynamics/element=p1_nodal"};
  bar.cell_fields["E"] = Field::Constant(bar.num_tets(), 1e5);
  const scenario::Scene fine = scenario::build_scene(load(write_scenario(fields, paper, ""), p1_nodal));
  EXPECT_NE(fine.medium_status.find("above_voigt"), std::string::npos) << fine.medium_status;
  bar.cell_fields["E"](7) = 1e4;
  test::expect_refused(folder, write_scenario(fields, paper, ""), p1_nodal,
                       {"effective_medium/scheme", "dilute gives", "phi = 0.62745", "E = 10000 Pa"});
  bar.cell_fields["E"].setConstant(1e5);  // whatever the material's own modulus, which no tet has
  EXPECT_NO_THROW(scenario::build_scene(
      load(write_scenario(fields, paper, ""), {p1_nodal[0], "/material/youngs_modulus_Pa=1e4"})));
}

TEST_F(BarWithFields, IsAskedUpToItsWettestTet) {
  const std::string paper = R"("scheme": "dilute", "fluid_bulk_modulus_Pa": 2.2e9)";
  const std::string fields = R"(, "saturation_field": "S")";
  bar.cell_fields["S"] = Field::Constant(bar.num_tets(), 0.4);
  bar.cell_fields["S"](3) = 0.7;
  const scenario::Scene scene =
      scenario::build_scene(load(write_scenario(fields, paper, ""), {"/dynamics/element=p1_nodal"}));
  EXPECT_EQ(scene.medium_status, "effective medium (undrained): ok; checked for phi from 0 to 0.455");
}

}  // namespace
}  // namespace argil
