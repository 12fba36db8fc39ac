// No number of a scenario, however far from any use, may end the program: it is refused by a message, or the
// scene stands. Each key of the parameter table gets several such numbers, alone.
#include <gtest/gtest.h>

#include <cstdio>

#include "refusal.h"
#include "scenario/parameter_table.h"

namespace argil {
namespace {

using scenario::Parameter;
using scenario::ValueType;

class ExtremeNumbers : public testing::Test {
 protected:
  test::TempFolder folder;
  std::string trace = test::write_press_trace(folder / "press.csv", 0.05, 0.0435, 0.1, "push");

  /// True when it was refused.
  bool try_setting(const std::string& setting, const std::vector<std::string>& others) {
    run::RunOptions options;
    options.quiet = options.dry_run = true;
    options.scenario = folder / "scene.json";
    options.settings = {"/body/shape/target_tets=100", setting};
    options.settings.insert(options.settings.end(), others.begin(), others.end());
    std::printf("%s\n", setting.c_str());  // the last one, should the program end here
    std::fflush(stdout);
    try {
      run::run(options);
      return false;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("scene.json"), std::string::npos) << setting << error.what();
      return true;
    }
  }

  /// Returns how many settings were tried.
  int try_all(const std::vector<std::string>& others) {
    test::write_text(folder / "scene.json", test::make_ball_scenario(trace));
    scenario::Scenario sample;
    int count = 0;
    for (const Parameter& row : scenario::make_parameter_table(sample, "")) {
      if (row.pointer == "/body/shape/target_tets" || row.pointer == "/body/shape/skin_triangles") continue;
      for (const std::string number : {"0", "-1", "1e-300", "1e-12", "1e12", "1e300"}) {
        const bool is_whole = number.find('e') == std::string::npos;
        if (row.type == ValueType::number || (row.type == ValueType::integer && is_whole))
          try_setting(row.pointer + "=" + number, others);
        else if (row.type == ValueType::numbers && row.length == 3)
          try_setting(row.pointer + "=[0," + number + ",0]", others);
        else
          continue;
        ++count;
      }
    }
    return count;
  }
};

TEST_F(ExtremeNumbers, AreRefusedOrMakeAScene) {
  EXPECT_GT(try_all({}), 400);
}

TEST_F(ExtremeNumbers, OfOtherToolsHandsAndLawsAreRefusedOrMakeAScene) {
  EXPECT_GT(try_all({"/body/shape/kind=box", "/tool/shape/kind=stylus", "/hand/kind=simulated",
                     "/water/diffusion=implicit", "/material/moisture/law=liquidity_index",
                     "/material/effective_medium/orientation=aligned"}),
            400);
}

TEST_F(ExtremeNumbers, OfClayAndWaterTogetherAreRefusedOrMakeAScene) {
  test::write_text(folder / "scene.json", test::make_ball_scenario(trace));
  for (const std::string scheme :
       {"dilute", "dilute_strain", "mori_tanaka", "self_consistent", "differential", "hs_lower", "hs_upper"})
    for (const std::string clay : {"1e-300", "1e-9", "1e5", "1e18", "1e300"})
      for (const std::string water : {"0", "1e-300", "2.2e9", "1e18", "1e300"})
        for (const std::string shear : {"0", "1e-300", "1e18"})
          try_setting(
              "/material/effective_medium/scheme=" + scheme,
              {"/material/youngs_modulus_Pa=" + clay, "/body/initial_saturation=0.8",
               "/material/effective_medium/fluid_bulk_modulus_Pa=" + water,
               "/material/effective_medium/fluid_shear_modulus_Pa=" + shear, "/dynamics/allow_locking=true"});
}

TEST_F(ExtremeNumbers, OfBodyToolAndClockAreRefusedByTheirRange) {
  const auto expect_range = [&](const std::string& setting, const std::string& range) {
    const std::string pointer = setting.substr(0, setting.find('='));
    test::expect_refused(folder, test::make_ball_scenario(trace), {setting},
                         {"scene.json", pointer, setting.substr(pointer.size() + 1), range, "in that range"});
  };
  expect_range("/haptics/period_s=1e-12", "[1e-06, 1.0) s");
  expect_range("/haptics/device/watchdog/release_s=1e+300", "[0.0, 100.0] s");
  for (const char* value : {"1e-300", "1e+300"}) {
    expect_range(std::string("/tool/shape/radius_m=") + value, "[1e-09, 1000000000.0] m");
    expect_range(std::string("/body/shape/size_m=") + value, "[1e-09, 1000000000.0] m");
  }
}

/// A file of its own has the body's or tool's size, which no range of the scenario knows.
TEST_F(ExtremeNumbers, OfAMeshFileAreRefused) {
  for (const double size : {1e-300, 1e-103, 1e-12, 1e12, 1e100}) {
    mesh::TetMesh tet;
    tet.vertices.resize(3, 4);
    tet.vertices << 0, size, 0, 0, 0, 0, size, 0, 0, 0, 0, size;
    tet.tets.resize(4, 1);
    tet.tets << 0, 1, 2, 3;
    std::string scenario = test::make_ball_scenario(trace);
    const std::string from =
        R"("shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0})";
    scenario.replace(scenario.find(from), from.size(),
                     R"("mesh": {"file": ")" + test::write_vtk(folder / "tet.vtk", tet) + R"("})");
    test::expect_refused(folder, scenario, {"/body/fixed=[]"}, {"tet.vtk", "metres"});
    std::ofstream(folder / "tool.obj") << "v 0 0 0\nv " << size << " 0 0\nv 0 " << size << " 0\nv 0 0 "
                                       << size << "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    test::expect_refused(folder, test::make_ball_scenario(trace),
                         {R"(/tool/shape={"kind":"mesh","file":")" + (folder / "tool.obj") + R"("})"},
                         {"tool.obj", "metres"});
  }
}

}  // namespace
}  // namespace argil
