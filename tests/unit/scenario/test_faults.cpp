// All that is wrong with a scenario in one message, in the order of its text; and what it may say but hardly
// means.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "scenario/build.h"
#include "scenario/json_document.h"
#include "scenario/scenario.h"
#include "scenario/scene_faults.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::scenario {
namespace {

class Faulty : public testing::Test {
 protected:
  test::TempFolder folder;

  /// The lines of the refusal.
  std::vector<std::string> list_faults(const std::string& text) {
    const std::string file = folder.write("scene.json", text);
    std::vector<std::string> lines;
    try {
      build_scene(load_scenario(file, {}, MotionSource::trace, find_scene_faults));
    } catch (const InputError& error) {
      std::istringstream words(error.what());
      for (std::string line; std::getline(words, line);) lines.push_back(line);
    }
    return lines;
  }
  void expect_faults(const std::string& text, const std::vector<std::string>& wanted) {
    const std::vector<std::string> lines = list_faults(text);
    ASSERT_EQ(lines.size(), wanted.size()) << testing::PrintToString(lines);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      EXPECT_NE(lines[i].find(wanted[i]), std::string::npos) << lines[i];
  }
};

TEST_F(Faulty, KeysAllAtOnceInTheOrderOfTheText) {
  test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  expect_faults(
      R"({
    "trace": {"file": "press.csv", "start": 0},
    "body": {"surface": {"file": "nothing.obj"},
             "fixed": [{"kind": "box", "lower": [0, 0, 0]}, {"kind": "ball"}, {"kind": "plane", "offset_m": "a"}]},
    "about": 3,
    "tool": {"shape": {"kind": "sphere", "radius_m": "8mm"}, "mode": "touch"},
    "colour": 1,
    "material": {"youngs_modulus": 1e5, "poissons_ratio": 0.7, "plasticity": {"strength_Pa": -4}}
  })",
      {"/trace/start: is not a known key; did you mean \"start_s\"?", "/body/surface/file: file \"",
       "/body/fixed/0/lower: is not a known key", "/body/fixed/1/kind: \"ball\" is not one of",
       "/body/fixed/2/offset_m: \"a\" is not a number in m", "/about: 3 is not a string",
       "/tool/shape/radius_m: \"8mm\" is not a number in m", "/tool/mode: \"touch\" is not one of",
       "/colour: is not a known key", "/material/youngs_modulus: is not a known key",
       "/material/poissons_ratio: 0.7 is outside", "/material/plasticity/strength_Pa: -4 is outside"});
}

TEST_F(Faulty, AKeyIsMissedOnceOnlyAndNotBelowAnotherFault) {
  expect_faults(
      R"({"about": "x", "body": {"shape": {"kind": "box"}}, "material": 5, "trace": {"fil": "a.csv"}})",
      {"/material: 5 is not an object", "/trace/fil: is not a known key; did you mean \"file\"?"});
  expect_faults(R"({"body": {"shape": {"kind": "box"}}, "material": {}, "trace": {}})",
                {"/material/youngs_modulus_Pa: is missing", "/material/poissons_ratio: is missing",
                 "/trace/file: is missing", "/about: is missing"});
}

TEST_F(Faulty, FilesBesideKeysAndCombinations) {
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  folder.write("still.csv", "t,x,y,z\n0,0,0,0\n0,0,0,0\n");
  const std::string rest = R"("body": {"surface": {"file": "open.obj"}}, "trace": {"file": "still.csv"},
    "tool": {"shape": {"kind": "stylus", "radius_m": 0.001, "tip_radius_m": 0.002}},
    "haptics": {"physics_period_ticks": 3})";
  expect_faults(
      R"({"about": "x", "material": {"youngs_modulus_Pa": 0, "poissons_ratio": 0.3}, )" + rest + "}",
      {"/material/youngs_modulus_Pa: 0 is outside", "still.csv: line 3", "open.obj: "});
  expect_faults(
      R"({"about": "x", "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3}, )" + rest + "}",
      {"/tool/shape/tip_radius_m: is not smaller", "/haptics/water_period_ticks: 10 is no multiple",
       "/haptics/frame_period_ticks: 100 is no multiple", "still.csv: line 3", "open.obj: "});
}

TEST_F(Faulty, SupportsThatHoldNothingAllOfThem) {
  test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  const std::string beyond = R"({"kind": "sphere", "centre_m": [9, 9, 9], "radius_m": 0.1})";
  expect_faults(R"({"about": "x", "body": {"shape": {"kind": "box", "size_m": 0.04, "target_tets": 300},
    "fixed": [)" + beyond +
                    R"(, {"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.01}, )" + beyond + R"(]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3}, "tool": {"mode": "push"}, "trace": {"file": "press.csv"}})",
                {"/body/fixed/0: holds no vertex", "/body/fixed/2: holds no vertex"});
}

/// A body of two tets whose file has a vertex that no tet uses as number 2, with cell data.
constexpr const char* kTwoTets = R"(# vtk DataFile Version 3.0
x
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 6 double
0 0 0 0.02 0 0 9 9 9 0 0.02 0 0 0 0.02 0.02 0.02 0.02
CELLS 2 10
4 0 1 3 4
4 1 3 4 5
CELL_TYPES 2
10
10
CELL_DATA 2
SCALARS S double
LOOKUP_TABLE default
0.5 1.5
)";

TEST_F(Faulty, FieldsSupportsAndLoadsOfABodyAllAtOnce) {
  folder.write("two.vtk", kTwoTets);
  const std::string text = R"({"about": "x", "dynamics": {"mode": "static"},
    "body": {"mesh": {"file": "two.vtk", "saturation_field": "S", "youngs_modulus_field": "E"},
             "fixed": [{"kind": "nodes", "nodes": [0, 1, 2]}, {"kind": "nodes", "nodes": [6]}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3}})";
  expect_faults(text, {"/body/fixed/0/nodes: 2 is a vertex that no tet of the mesh uses",
                       "/body/fixed/1/nodes: 6 is no vertex", "cell data \"S\" is 1.5",
                       "has no cell data named \"E\""});
}

// The readers of meshes let NaN pass in what nothing uses.
TEST_F(Faulty, AFieldThatTheBodyUsesMustBeFinite) {
  std::string two_tets = kTwoTets;
  two_tets.replace(two_tets.find("0.5 1.5"), 7, "0.5 nan");
  folder.write("two.vtk", two_tets);
  const auto text = [](const std::string& field) {
    return R"({"about": "x", "dynamics": {"mode": "static"}, "body": {"mesh": {"file": "two.vtk")" + field +
           R"(}, "fixed": [{"kind": "nodes", "nodes": [0, 1, 3]}]},
           "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3}})";
  };
  EXPECT_NO_THROW(build_scene(load_scenario(folder.write("unused.json", text("")), {})));
  expect_faults(text(R"(, "saturation_field": "S")"),
                {"two.vtk: tet 1: cell data \"S\" is nan, outside [0, 1]; correct the file"});
  expect_faults(text(R"(, "youngs_modulus_field": "S")"),
                {"two.vtk: tet 1: cell data \"S\" is nan, outside"});
}

TEST_F(Faulty, EachLoadIsCheckedAndListsCountTheFilesVertices) {
  folder.write("two.vtk", kTwoTets);
  const std::string held = R"("fixed": [{"kind": "nodes", "nodes": [0, 1, 3]}], )";
  const auto scene = [&](const std::string& loads) {
    return R"({"about": "x", "dynamics": {"mode": "static"}, "body": {"mesh": {"file": "two.vtk"}, )" + held +
           R"("loads": )" + loads + R"(}, "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3}})";
  };
  expect_faults(
      scene(R"({"nodal": [{"nodes": [2], "force_N": [0, 0, 1]}, {"nodes": [9], "force_N": [0, 0, 1]}],
      "pressure": [{"kind": "sphere", "centre_m": [9, 9, 9], "radius_m": 0.1, "pressure_Pa": 1}]})"),
      {"/body/loads/nodal/0/nodes: 2 is a vertex that no tet",
       "/body/loads/nodal/1/nodes: 9 is no vertex of the mesh; give numbers from 0 to 5",
       "/body/loads/pressure/0: holds no boundary face"});
  const std::string file =
      folder.write("good.json", scene(R"({"nodal": [{"nodes": [5], "force_N": [0, 0, 1]}]})"));
  const Scene made = build_scene(load_scenario(file, {}));
  EXPECT_EQ(made.body.mesh.num_vertices(), 5);
  EXPECT_EQ(made.body.supports.at(0).region.nodes, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(made.body.loads.nodal.at(0).nodes, std::vector<int>{4});
  EXPECT_NE(made.notes.at(0).find("1 of 6 vertices belong to no tet"), std::string::npos) << made.notes.at(0);
  EXPECT_NE(made.notes.at(0).find("lists of vertices go on counting them"), std::string::npos);
}

TEST_F(Faulty, ToolMotionAndBodyAtOnce) {
  test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string beyond = R"({"kind": "sphere", "centre_m": [9, 9, 9], "radius_m": 0.1})";
  const auto scene = [&](const std::string& cells, const std::string& modulus) {
    return R"({"about": "x", "body": {"shape": {"kind": "box", "size_m": 0.04, "target_tets": 300}, "fixed": [)" +
           beyond + R"(], "cells": {"kind": ")" + cells + R"("}},
    "material": {"youngs_modulus_Pa": )" +
           modulus + R"(, "poissons_ratio": 0.3},
    "tool": {"shape": {"kind": "mesh", "file": "open.obj"}, "mode": "push"},
    "trace": {"file": "press.csv", "start_s": 99}})";
  };
  const std::vector<std::string> faults = {"/trace/start_s: lies past", "/body/fixed/0: holds no vertex",
                                           "open.obj: "};
  expect_faults(scene("even", "1e5"), faults);
  // Cells that tool and motion would grade; and beside keys that are wrong.
  expect_faults(scene("graded", "1e5"), faults);
  for (const char* cells : {"even", "graded"})
    expect_faults(scene(cells, "-1"), {"/body/fixed/0: holds no vertex", "/material/youngs_modulus_Pa: -1 is",
                                       "/trace/start_s: lies past", "open.obj: "});
}

TEST_F(Faulty, ABodyThatItsKeysDoNotSayIsNotJudged) {
  folder.write("two.vtk", kTwoTets);
  const std::string lists = R"("fixed": [{"kind": "nodes", "nodes": [9]}]})";
  const std::string rest =
      R"(, "material": {"youngs_modulus_Pa": 0, "poissons_ratio": 0.3}, "dynamics": {"mode": "static"}})";
  expect_faults(R"({"about": "x", "body": {"mesh": {"file": "two.vtk"}, )" + lists + rest,
                {"/body/fixed/0/nodes: 9 is no vertex", "/material/youngs_modulus_Pa: 0 is outside"});
  expect_faults(R"({"about": "x", "body": {"mesh": {"file": "two.vtk", "scale": 0}, )" + lists + rest,
                {"/body/mesh/scale: 0 is outside", "/material/youngs_modulus_Pa: 0 is outside"});
}

TEST_F(Faulty, OneBodyAndOneTool) {
  const std::string material = R"("material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3})";
  for (const char* key : {"tool", "tools"})
    EXPECT_NE(list_faults(R"({"about": "x", "body": {"shape": {"kind": "box"}}, )" + material + ", \"" + key +
                          "\": [{}, {}]}")[0]
                  .find(": a run has one body and one rigid tool"),
              std::string::npos)
        << key;
  for (const char* key : {"body", "bodies"})
    EXPECT_NE(
        list_faults(std::string("{\"about\": \"x\", \"") + key + "\": [{}, {}], " + material + "}")[0].find(
            ": a run has one body and one rigid tool"),
        std::string::npos)
        << key;
}

class Doubtful : public testing::Test {
 protected:
  test::TempFolder folder;
  std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
  std::string file = folder.write("scene.json", R"({"about": "x",
    "body": {"shape": {"kind": "box", "size_m": 0.04},
             "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.01}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3},
    "tool": {"mode": "push"}, "trace": {"file": "press.csv"}})");

  /// The only warning that the settings bring.
  std::string doubt(const std::vector<std::string>& settings) {
    std::vector<Setting> parsed;
    for (const std::string& text : settings) parsed.push_back(parse_setting(text));
    const std::vector<std::string> warnings = load_scenario(file, parsed).warnings;
    EXPECT_LE(warnings.size(), 1u) << testing::PrintToString(warnings);
    return warnings.empty() ? "" : warnings.front();
  }
  void expect_doubt(const std::vector<std::string>& settings, const std::string& pointer,
                    const std::string& remedy) {
    const std::string said = doubt(settings);
    EXPECT_NE(said.find(file + ": " + pointer + ": "), std::string::npos) << said;
    EXPECT_NE(said.find(remedy), std::string::npos) << said;
  }
};

TEST_F(Doubtful, PlainScenariosAreNot) {
  EXPECT_EQ(doubt({}), "");
  EXPECT_EQ(doubt({"/material/plasticity/strength_Pa=1500"}), "");
  EXPECT_EQ(doubt({R"(/material/plasticity={"yield": 0.01, "creep_per_s": 20, "max": 0.5})"}), "");
  EXPECT_EQ(doubt({R"(/material/plasticity={"yield": 0.01, "form": "j2"})"}), "");
  EXPECT_EQ(doubt({R"(/material/plasticity={"yield": 0.01, "creep_per_s": 0, "enabled": false})"}), "");
  EXPECT_EQ(doubt({"/contact/stiffness_Pa_per_m=1e9"}), "");
}

TEST_F(Doubtful, EachIsAnsweredByTheWordThatHelps) {
  expect_doubt({"/body/fixed=[]"}, "/body/fixed", "hold its foot");
  expect_doubt({"/material/youngs_modulus_Pa=1.2"}, "/material/youngs_modulus_Pa",
               "write 1.2 kPa as 1200, MPa as 1.2e+06");
  expect_doubt({"/material/youngs_modulus_Pa=1e15"}, "/material/youngs_modulus_Pa", "give it in pascals");
  expect_doubt({R"(/material/plasticity={"yield": 1500, "creep_per_s": 20, "max": 0.5})"},
               "/material/plasticity/yield", "a strength of 1500 Pa is written strength_Pa");
  expect_doubt({"/material/plasticity/strength_Pa=0.02"}, "/material/plasticity/strength_Pa",
               "is written yield");
  expect_doubt({"/material/plasticity/strength_Pa=1.5"}, "/material/plasticity/strength_Pa",
               "1.5 kPa is 1500");
  expect_doubt({"/material/plasticity/strength_Pa=2e5"}, "/material/plasticity/strength_Pa",
               "50 to 200 strengths");
  expect_doubt({R"(/material/plasticity={"yield": 0.01, "creep_per_s": 0})"},
               "/material/plasticity/creep_per_s", "give for instance 20");
  expect_doubt({R"(/material/plasticity={"yield": 0.01, "creep_per_s": 20})"}, "/material/plasticity/max",
               "give 0.5");
  expect_doubt({"/contact/stiffness_Pa_per_m=1e20"}, "/contact/stiffness_Pa_per_m", "leave it out");
  expect_doubt({"/contact/stiffness_Pa_per_m=1"}, "/contact/stiffness_Pa_per_m", "leave it out");
  expect_doubt(
      {R"(/contact={"law": "pairs", "vertex_face_stiffness_N_per_m": 1e9, "edge_edge_stiffness_N_per_m": 0})"},
      "/contact/vertex_face_stiffness_N_per_m", "times a cell's size");
}

}  // namespace
}  // namespace argil::scenario
