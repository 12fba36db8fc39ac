// The result file and its XDMF as programs that are not ours see them: h5py, h5dump, an XML parser.
#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;

int run(const std::string& command) {
  return std::system(command.c_str());
}

TEST(OtherReaders, H5pyFindsEveryDatasetAsDescribedAndTheXdmfNamesThem) {
  const std::string python = "/usr/bin/python3";
  if (run(python + " -c 'import h5py, numpy' 2>/dev/null") != 0)
    GTEST_SKIP() << "needs " << python << " with h5py";
  const TempFolder folder;
  std::filesystem::create_directory(folder / "pictures & more");
  test::write_run(folder / "run.h5", 1100);
  write_xdmf(folder / "run.h5", folder / "pictures & more/run.xdmf");
  const std::string script = std::string(ARGIL_SOURCE_DIR) + "/tests/unit/output/check_result.py";
  EXPECT_EQ(run(python + " '" + script + "' '" + folder / "run.h5" + "' '" +
                folder / "pictures & more/run.xdmf" + "' 1100"),
            0);
}

TEST(OtherReaders, ParaViewFindsEveryFrameAndItsSaturation) {
  const std::string pvbatch = std::string("'") + ARGIL_SOURCE_DIR + "/scripts/pvbatch' ";
  if (run(pvbatch + "--version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "needs ParaView and its Python modules";
  const TempFolder folder;
  test::write_run(folder / "run.h5", 101);
  write_xdmf(folder / "run.h5", folder / "run.xdmf");
  const std::string script = std::string(ARGIL_SOURCE_DIR) + "/tests/unit/output/check_in_paraview.py";
  EXPECT_EQ(run(pvbatch + "'" + script + "' '" + folder / "run.xdmf" + "' 11"), 0);
}

TEST(OtherReaders, H5dumpReadsTheWholeFile) {
  if (run("h5dump --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "needs h5dump";
  const TempFolder folder;
  test::write_run(folder / "run.h5", 30);
  EXPECT_EQ(run("h5dump '" + folder / "run.h5" + "' > '" + folder / "dump.txt" + "' 2>&1"), 0);
  const std::string dump = TempFolder::read(folder / "dump.txt");
  EXPECT_EQ(dump.find("unable"), std::string::npos);
  EXPECT_NE(dump.find("DATASET \"skin_influence\""), std::string::npos);
}

TEST(WriteXdmf, LeavesTheSkinOutWhenThereIsNone) {
  const TempFolder folder;
  test::write_run(folder / "run.h5", 11, false);
  write_xdmf(folder / "run.h5", folder / "run.xdmf");
  const std::string text = TempFolder::read(folder / "run.xdmf");
  EXPECT_NE(text.find(">run.h5:/frames/000001/position<"), std::string::npos) << text;
  EXPECT_EQ(text.find("skin"), std::string::npos);
}

TEST(WriteXdmf, SaysWhyItCannot) {
  const TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(write_xdmf(folder / "absent.h5", folder / "x.xdmf"), IoError,
                          "absent.h5: cannot be read");
  test::write_run(folder / "run.h5", 1);
  ARGIL_EXPECT_THROW_WITH(write_xdmf(folder / "run.h5", "/nowhere/x.xdmf"), IoError,
                          "cannot be written: No such file");
  ARGIL_EXPECT_THROW_WITH(write_xdmf(folder / "run.h5", "/dev/full"), IoError, "No space left on device");
}

}  // namespace
}  // namespace argil::output
