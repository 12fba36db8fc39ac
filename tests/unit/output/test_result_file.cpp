// The result file as its README describes it: bits of two equal runs, what a killed or failed run leaves,
// refusals. What other programs read from it is tested by check_result.py.
#include "output/result_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "base/error.h"
#include "hdf5/file.h"
#include "records.h"
#include "support/temp_folder.h"

namespace argil::output {
namespace {

using argil::test::TempFolder;
using hdf5::File;
using hdf5::Group;
using hdf5::Shape;

TEST(ResultFile, KeepsEveryHapticRecordAcrossChunks) {
  const TempFolder folder;
  test::write_run(folder / "r.h5", 2500);  // two whole chunks and a part
  const File file = File::open_for_reading(folder / "r.h5");
  const Group haptic = file.root().open_group("haptic");
  EXPECT_EQ(haptic.open_dataset("time").shape(), (Shape{2500}));
  EXPECT_EQ(haptic.open_dataset("force").shape(), (Shape{2500, 3}));
  const std::vector<double> force = haptic.open_dataset("force").read<double>();
  const std::vector<double> orientation = haptic.open_dataset("tool_orientation").read<double>();
  const std::vector<std::uint8_t> mode = haptic.open_dataset("mode").read<std::uint8_t>();
  for (std::size_t i = 0; i < 2500; ++i) {
    ASSERT_EQ(force[3 * i], 1.0 / (static_cast<double>(i) + 3.0));
    ASSERT_EQ(force[3 * i + 2], 3.0 * static_cast<double>(i));
    ASSERT_EQ(mode[i], i % 4);
    // x, y, z, w of Quat(w 0.5, x 0.5, y −0.5, z 0.5)
    ASSERT_EQ(orientation[4 * i + 1], -0.5);
    ASSERT_EQ(orientation[4 * i + 3], 0.5);
  }
}

TEST(ResultFile, GivesEqualBytesForEqualRuns) {
  const TempFolder folder;
  test::write_run(folder / "a.h5", 1500);
  test::write_run(folder / "b.h5", 1500);
  const std::string a = TempFolder::read(folder / "a.h5");
  EXPECT_GT(a.size(), 100000U);
  EXPECT_TRUE(a == TempFolder::read(folder / "b.h5"));
}

TEST(ResultFile, IsCompleteOnlyWhenTheRunReachedItsEnd) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  const auto outcome = [&] {
    const Group root = File::open_for_reading(name).root();
    return root.read_text("outcome") + " " + std::to_string(root.read_integer("complete"));
  };
  test::write_run(name, 3);
  EXPECT_EQ(outcome(), "done 1");
  {
    ResultFile file(name, test::make_header());
    test::append_run(file, 0, 3);
  }
  EXPECT_EQ(outcome(), "running 0");
  EXPECT_EQ(File::open_for_reading(name).root().open_dataset("haptic/tick").shape(), (Shape{3}));
  ResultFile interrupted(name, test::make_header());
  interrupted.finish(std::nullopt, true);
  EXPECT_EQ(outcome(), "interrupted 0");
  ResultFile failed(name, test::make_header());
  failed.finish(Failure{7, "solid", 3, "volume ratio", -0.25, 0.0});
  EXPECT_EQ(outcome(), "failed 0");
  const Group failure = File::open_for_reading(name).root().open_group("failure");
  EXPECT_EQ(failure.read_integer("tick"), 7);
  EXPECT_EQ(failure.read_text("stage"), "solid");
  EXPECT_EQ(failure.read_integer("element"), 3);
  EXPECT_EQ(failure.read_text("quantity"), "volume ratio");
  EXPECT_EQ(failure.read_real("value"), -0.25);
  EXPECT_EQ(failure.read_real("bound"), 0.0);
}

TEST(ResultFile, AKilledRunKeepsAllButItsLastChunk) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ResultFile file(name, test::make_header());
    test::append_run(file, 0, 2500);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const Group root = File::open_for_reading(name).root();
  EXPECT_EQ(root.read_text("outcome"), "running");
  EXPECT_EQ(root.open_dataset("haptic/force").shape(), (Shape{2048, 3}));
  EXPECT_EQ(root.open_dataset("physics/residual").shape(), (Shape{1024}));
  EXPECT_EQ(root.open_dataset("haptic/force").read<double>()[3 * 2047 + 2], 3.0 * 2047);
  EXPECT_EQ(root.open_group("frames").names().size(), 250U);
  EXPECT_EQ(root.open_dataset("frames/000249/saturation").read<double>()[1], 0.75);
}

TEST(ResultFile, IsRefusedWhileAnotherProcessWritesItAndThatOneLosesNothing) {
  const TempFolder folder;
  const std::string name = folder / "r.h5";
  ResultFile file(name, test::make_header());
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // flock belongs to the open descriptor, and the second writer opens its own.
    try {
      ResultFile second(name, test::make_header());
      _exit(1);
    } catch (const IoError& error) {
      _exit(std::string(error.what()).find("another process has this file open") != std::string::npos ? 0
                                                                                                      : 2);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  test::append_run(file, 0, 5);
  file.finish(std::nullopt);
  EXPECT_EQ(File::open_for_reading(name).root().open_dataset("haptic/tick").shape(), (Shape{5}));
}

TEST(ResultFile, SaysWhyItCannotBeMade) {
  const TempFolder folder;
  const ResultHeader header = test::make_header();
  ARGIL_EXPECT_THROW_WITH(ResultFile(folder / "no/r.h5", header), IoError,
                          "no/r.h5: cannot be written: No such file");
  folder.write("plain", "x");
  ARGIL_EXPECT_THROW_WITH(ResultFile(folder / "plain/r.h5", header), IoError, "Not a directory");
  std::filesystem::create_directory(folder / "d.h5");
  ARGIL_EXPECT_THROW_WITH(ResultFile(folder / "d.h5", header), IoError, "Is a directory");
  ARGIL_EXPECT_THROW_WITH(ResultFile("/dev/null", header), IoError, "is not a regular file");
}

TEST(ResultFile, SaysThatTheDiskIsFull) {
  const TempFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // a limit on the file's size stands for the full disk
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{400000, 400000};
    setrlimit(RLIMIT_FSIZE, &limit);
    int code = 1;
    try {
      ResultFile file(folder / "r.h5", test::make_header());
      test::append_run(file, 0, 20000);
    } catch (const IoError& error) {
      code = std::string(error.what()).find("File too large") != std::string::npos ? 0 : 2;
      if (code != 0) std::fprintf(stderr, "%s\n", error.what());
    }
    std::exit(code);  // the library's own clean-up must end, too
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace argil::output
