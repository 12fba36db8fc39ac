// No run writes over what it reads: neither its result nor the XDMF beside it.
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "run/files.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

class OutputName : public testing::Test {
 protected:
  test::TempFolder folder;
  run::RunOptions options;

  void SetUp() override {
    options.quiet = true;
    options.settings = {"/trace/duration_s=0.002"};
    const std::string trace = test::write_press_trace(folder / "press.csv", 0.048, 0.0435, 0.1, "push");
    options.scenario = folder.write("scene.json", test::make_ball_scenario(trace));
  }
  /// Refused with these words, and the file still what it was.
  void expect_refused(const std::string& output, const std::string& input, const std::string& words) {
    const std::string before = test::TempFolder::read(folder / input);
    ASSERT_FALSE(before.empty());
    options.output = output.empty() ? "" : folder / output;
    ARGIL_EXPECT_THROW_WITH(run::run(options), InputError, words);
    EXPECT_EQ(test::TempFolder::read(folder / input), before);
  }
};

TEST_F(OutputName, OfTheScenarioIsRefused) {
  expect_refused("scene.json", "scene.json", "scene.json: is the scenario and would be overwritten; give");
}

TEST_F(OutputName, OfAnotherFormatIsRefused) {
  for (const char* name : {"force.csv", "body.vtu", "page.html"}) {
    options.output = folder / name;
    ARGIL_EXPECT_THROW_WITH(run::run(options), InputError, "and a result is written as HDF5; give");
    EXPECT_FALSE(std::filesystem::exists(options.output));
  }
}

TEST_F(OutputName, OfTheTraceIsRefused) {
  expect_refused("press.csv", "press.csv", "press.csv: is a file that the run reads (/trace/file)");
}

TEST_F(OutputName, OfATraceGivenOnTheCommandLineIsRefused) {
  options.trace = test::write_press_trace(folder / "other.csv", 0.048, 0.0435, 0.1, "push");
  expect_refused("other.csv", "other.csv", "other.csv: is a file that the run reads (/trace/file)");
}

TEST_F(OutputName, OfTheBodysMeshOrItsOtherHalfIsRefused) {
  const std::string shape =
      R"("shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 600, "skin_triangles": 0})";
  std::string text = test::TempFolder::read(options.scenario);
  text.replace(text.find(shape), shape.size(), R"("mesh": {"file": "body.ele"})");
  folder.write("scene.json", text);
  folder.write("body.ele", "1 4 0\n0 0 1 2 3\n");
  folder.write("body.node", "4 3 0 0\n0 0 0 0\n1 0.02 0 0\n2 0 0.02 0\n3 0 0 0.02\n");
  expect_refused("body.ele", "body.ele", "(/body/mesh/file)");
  expect_refused("body.node", "body.node", "(/body/mesh/file)");
}

TEST_F(OutputName, ThatLinksToAnInputIsRefused) {
  std::filesystem::create_symlink(folder / "press.csv", folder / "link.h5");
  expect_refused("link.h5", "press.csv", "link.h5: is a file that the run reads (/trace/file)");
}

TEST_F(OutputName, WhoseXdmfIsAnInputIsRefused) {
  std::filesystem::rename(options.scenario, folder / "scene.xdmf");
  options.scenario = folder / "scene.xdmf";
  expect_refused("scene.h5", "scene.xdmf", "scene.xdmf: is the scenario");
}

TEST_F(OutputName, OfTheXdmfIsRefused) {
  options.output = folder / "out.xdmf";
  ARGIL_EXPECT_THROW_WITH(run::run(options), InputError, "give -o a name such as out.h5");
  EXPECT_FALSE(std::filesystem::exists(options.output));
}

TEST_F(OutputName, OfAnEarlierResultIsWrittenOver) {
  options.output = folder / "out.h5";
  ASSERT_EQ(run::run(options), run::kDone);
  EXPECT_EQ(run::run(options), run::kDone);
}

TEST_F(OutputName, OfACageIsGmshsAndNotTheSurfaces) {
  const std::string surface = folder.write("skin.obj", "v 0 0 0\n");
  ARGIL_EXPECT_THROW_WITH(run::check_cage_name(surface, surface), InputError, "is the surface and would");
  ARGIL_EXPECT_THROW_WITH(
      run::check_cage_name(surface, folder / "cage.vtk"), InputError,
      "cage.vtk: does not end in .msh, and a cage is written as Gmsh; give -o a name such as "
      "cage.msh");
  std::filesystem::create_hard_link(surface, folder / "link.msh");
  ARGIL_EXPECT_THROW_WITH(run::check_cage_name(surface, folder / "link.msh"), InputError, "is the surface");
  EXPECT_NO_THROW(run::check_cage_name(surface, folder / "cage.msh"));
}

}  // namespace
}  // namespace argil
