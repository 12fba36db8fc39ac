// A series of .vtu files as VTK reads it.
#include "output/vtu.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

void expect_vtk_reads(const TempFolder& folder) {
  const std::string python = "/usr/bin/python3";
  if (std::system((python + " -c 'import h5py, vtkmodules' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "needs " << python << " with h5py and vtk (package python3-vtk9)";
  const std::string script = std::string(ARGIL_SOURCE_DIR) + "/tests/unit/output/check_vtu.py";
  const std::string command =
      python + " '" + script + "' '" + folder / "run.h5" + "' '" + folder / "a & b.pvd" + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(WriteVtuSeries, VtkFindsTheBitsOfCageAndSkin) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 21);
  EXPECT_EQ(write_vtu_series(folder / "run.h5", folder / "a & b.pvd"), 3U);
  expect_vtk_reads(folder);
}

TEST(WriteVtuSeries, VtkFindsTheCageAloneWithoutASkin) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 11, false);
  write_vtu_series(folder / "run.h5", folder / "a & b.pvd");
  expect_vtk_reads(folder);
}

TEST(WriteVtuSeries, RefusesAnotherSuffixAndAResultWithoutFrames) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 0);
  ARGIL_EXPECT_THROW_WITH(write_vtu_series(folder / "run.h5", folder / "a.vtu"), InputError,
                          "does not end in .pvd");
  ARGIL_EXPECT_THROW_WITH(write_vtu_series(folder / "run.h5", folder / "a.pvd"), InputError, "has no frames");
}

TEST(WriteVtuSeries, SaysWhyItCannotMakeItsFolder) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 11);
  ARGIL_EXPECT_THROW_WITH(write_vtu_series(folder / "run.h5", folder / "run.h5/a.pvd"), IoError,
                          "cannot be made");
}

}  // namespace
}  // namespace argil::output
