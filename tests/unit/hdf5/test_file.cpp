// The door to HDF5: what is written is read back, what is killed stays as it was at its last flush, errors
// are named.
#include "hdf5/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

#include "base/error.h"
#include "hdf5/journal.h"
#include "support/temp_folder.h"

namespace argil::hdf5 {
namespace {

using test::TempFolder;

TEST(Hdf5File, GivesBackAttributesAndReplacesThem) {
  const TempFolder folder;
  {
    const File file = File::create(folder / "f.h5");
    Group root = file.root();
    root.write_attribute("text", "ε = 0");
    root.write_attribute("empty", "");
    root.write_attribute("number", 0.1);
    root.write_attribute("count", std::int64_t{-7});
    root.write_attribute("text", "a longer text than before");
  }
  const Group root = File::open_for_reading(folder / "f.h5").root();
  EXPECT_EQ(root.read_text("text"), "a longer text than before");
  EXPECT_EQ(root.read_text("empty"), "");
  EXPECT_EQ(root.read_real("number"), 0.1);
  EXPECT_EQ(root.read_integer("count"), -7);
  EXPECT_EQ(root.attribute_names(), (std::vector<std::string>{"count", "empty", "number", "text"}));
  ARGIL_EXPECT_THROW_WITH(root.read_text("absent"), IoError, "cannot read attribute absent of /");
  ARGIL_EXPECT_THROW_WITH(root.read_text("number"), IoError, "attribute number of / is not text");
}

TEST(Hdf5File, GrowsASeriesAndCutsIt) {
  const TempFolder folder;
  const File file = File::create(folder / "f.h5");
  Dataset series = file.root().create_series("s", Element::real64, {2}, 3, {"m", "a series of pairs"});
  const std::vector<double> values = {1, 2, 3, 4, 5, 6, 7, 8};
  series.append(values.data(), 1);
  series.append(values.data() + 2, 3);
  EXPECT_EQ(series.shape(), (Shape{4, 2}));
  EXPECT_EQ(series.read<double>(), values);
  series.truncate(2);
  series.append(values.data() + 6, 1);
  EXPECT_EQ(series.read<double>(), (std::vector<double>{1, 2, 3, 4, 7, 8}));
  ARGIL_EXPECT_THROW_WITH(series.truncate(4), IoError, "fewer than 4 rows");
}

TEST(Hdf5File, KeepsTheBitsOfEveryKindOfNumberPlainAndCompressed) {
  const TempFolder folder;
  const File file = File::create(folder / "f.h5");
  std::vector<double> values(9000, 0.0);
  values[1] = -0.0;
  values[2] = std::numeric_limits<double>::denorm_min();
  values[8999] = std::numeric_limits<double>::infinity();
  for (const bool compress : {false, true}) {
    const std::string name = compress ? "compressed" : "plain";
    file.root().write_array(name, values.data(), {3000, 3}, compress, {"1", "numbers"});
    const std::vector<double> read = file.root().open_dataset(name).read<double>();
    EXPECT_EQ(read, values);
    EXPECT_TRUE(std::signbit(read[1]));
  }
  const std::int64_t large = std::numeric_limits<std::int64_t>::min();
  file.root().write_array("large", &large, {}, false, {"1", "a number"});
  EXPECT_EQ(file.root().open_dataset("large").read<std::int64_t>(), std::vector<std::int64_t>{large});
  file.root().write_array("none", values.data(), {0, 3}, true, {"1", "no rows"});
  EXPECT_EQ(file.root().open_dataset("none").shape(), (Shape{0, 3}));
}

TEST(Hdf5File, ALinkIsASecondNameForOneDataset) {
  const TempFolder folder;
  const File file = File::create(folder / "f.h5");
  const Group root = file.root();
  const double value = 7.0;
  root.create_group("a").write_array("x", &value, {1}, false, {"m", "a number"});
  root.create_group("b").link_dataset("y", "/a/x");
  EXPECT_EQ(root.open_dataset("b/y").find_identity(), root.open_dataset("a/x").find_identity());
  root.open_group("a").remove("x");
  EXPECT_EQ(root.open_dataset("b/y").read<double>(), std::vector<double>{7.0});
  EXPECT_EQ(root.open_dataset("b/y").read_text("units"), "m");
  ARGIL_EXPECT_THROW_WITH(root.link_dataset("z", "/a/x"), IoError, "cannot link /a/x to /z");
}

// A thousand equal numbers take some tens of bytes where they are compressed.
TEST(Hdf5File, SeriesAreCompressedButNotInASharedFile) {
  const TempFolder folder;
  const std::vector<double> values(100000, 0.1);
  const auto find_size = [&](File file) {
    file.root()
        .create_series("s", Element::real64, {}, 1000, {"m", "a series"})
        .append(values.data(), 100000);
    EXPECT_EQ(file.root().open_dataset("s").read<double>(), values);
    const std::string name = file.name();
    file.close();
    return std::filesystem::file_size(name);
  };
  EXPECT_LT(find_size(File::create(folder / "f.h5")), 100000U);
  EXPECT_GT(find_size(File::create_shared(folder / "s.h5")), 800000U);
}

// Thousands of groups are more than the library's cache holds: without care it would write some of them
// between two flushes, and a kill would leave a file that is neither the old nor the new one.
TEST(Hdf5File, AKilledWriterLeavesTheFileOfItsLastFlush) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  const auto add_groups = [](const Group& root, int begin, int end) {
    for (int i = begin; i < end; ++i)
      root.create_group(std::string("g").append(std::to_string(i)))
          .write_attribute("text", std::string(500, 'x'));
  };
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    File file = File::create(name);
    const Group root = file.root();
    add_groups(root, 0, 10);
    file.flush();
    add_groups(root, 10, 8000);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  const Group root = File::open_for_reading(name).root();
  EXPECT_EQ(root.names().size(), 10U);
  for (const std::string& group : root.names())
    EXPECT_EQ(root.open_group(group).read_text("text").size(), 500U);
}

TEST(Hdf5File, ASyncIsAFlushAndGivesANewFileItsName) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    File file = File::create(name);
    const Group root = file.root();
    root.create_group("kept");
    file.sync();
    root.create_group("lost");
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(File::open_for_reading(name).root().names(), std::vector<std::string>{"kept"});
}

/// Adds row after row to a table and a list of groups, with a flush a row, until it is killed.
[[noreturn]] void write_until_killed(const std::string& name, int microseconds) {
  itimerval timer = {};
  timer.it_value.tv_usec = microseconds;
  File file = File::create(name);
  const Group root = file.root();
  Dataset rows = root.create_series("rows", Element::int64, {500}, 4, {"1", "the same number all along"});
  file.flush();
  setitimer(ITIMER_REAL, &timer, nullptr);
  for (std::int64_t i = 0;; ++i) {
    const std::vector<std::int64_t> row(500, i);
    rows.append(row.data(), 1);
    root.create_group("g" + std::to_string(i)).write_attribute("text", std::string(500, 'x'));
    if (i > 3) root.remove("g" + std::to_string(i - 3));  // so that space is used again
    file.flush();
  }
}

TEST(Hdf5File, IsWholeAfterAKillAtAnyMoment) {
  const TempFolder folder;
  const std::string name = folder / "f.h5";
  std::size_t most = 0;
  for (int run = 0; run < 60; ++run) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_until_killed(name, 1 + 397 * run);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const Group root = File::open_for_reading(name).root();
    const Dataset rows = root.open_dataset("rows");
    const std::vector<std::int64_t> read = rows.read<std::int64_t>();
    const std::size_t count = rows.shape()[0];
    for (std::size_t i = 0; i < read.size(); ++i) ASSERT_EQ(read[i], static_cast<std::int64_t>(i / 500));
    ASSERT_EQ(root.names().size(), 1 + std::min<std::size_t>(count, count > 4 ? 4 : count)) << count;
    most = std::max(most, count);
    ASSERT_FALSE(std::filesystem::exists(internal::name_journal(name)));
  }
  EXPECT_GT(most, 10U);
}

TEST(Journal, FinishesAWriteThatWasKilledAndKnowsATornOne) {
  const TempFolder folder;
  internal::Pages pages;
  pages[1].assign(internal::kPageBytes, 'b');
  pages[3].assign(internal::kPageBytes, 'd');  // the file grows into its half
  const std::string old = std::string(2 * internal::kPageBytes, 'a');
  const std::size_t size = 3 * internal::kPageBytes + 7;
  const std::string name = folder.write("f", old);
  const std::string journal = internal::name_journal(name);
  const int descriptor = open(journal.c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_TRUE(internal::write_journal(descriptor, pages, size));
  close(descriptor);
  const std::string whole = TempFolder::read(journal);
  std::string flipped = whole;
  flipped[5000] ^= 1;
  for (const std::string& torn :
       {std::string(), whole.substr(0, 20), whole.substr(0, whole.size() - 1), flipped}) {
    folder.write("f.journal", torn);
    internal::recover(name);
    EXPECT_TRUE(TempFolder::read(name) == old) << torn.size();
    EXPECT_FALSE(std::filesystem::exists(journal));
  }
  folder.write("f.journal", whole);
  internal::recover(name);
  const std::string page(internal::kPageBytes, 'a');
  EXPECT_TRUE(TempFolder::read(name) == page + std::string(internal::kPageBytes, 'b') +
                                            std::string(internal::kPageBytes, '\0') + "ddddddd");
  EXPECT_FALSE(std::filesystem::exists(journal));
}

TEST(Hdf5File, ReplacesAnOldFileAndFollowsALink) {
  const TempFolder folder;
  folder.write("old.h5", "not HDF5");
  std::filesystem::create_symlink(folder / "old.h5", folder / "link.h5");
  File::create(folder / "link.h5").close();
  EXPECT_TRUE(is_hdf5(folder / "old.h5"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.h5"));
}

TEST(Hdf5File, NamesMissingObjectsAndWrongTypes) {
  const TempFolder folder;
  const File file = File::create(folder / "f.h5");
  const Group group = file.root().create_group("g");
  group.write_string("s", "words", {"-", "a text"});
  EXPECT_EQ(group.open_dataset("s").read_string(), "words");
  ARGIL_EXPECT_THROW_WITH(group.open_dataset("absent"), IoError, "cannot open dataset /g/absent");
  ARGIL_EXPECT_THROW_WITH(group.open_group("s"), IoError, "cannot open group /g/s");
  ARGIL_EXPECT_THROW_WITH(group.open_dataset("s").read<double>(), IoError, "/g/s is text where numbers");
  ARGIL_EXPECT_THROW_WITH(file.root().create_group("g"), IoError, "cannot create /g");
}

TEST(IsHdf5, KnowsAFileByItsContent) {
  const TempFolder folder;
  File::create(folder / "yes.csv").close();
  EXPECT_TRUE(is_hdf5(folder / "yes.csv"));
  EXPECT_FALSE(is_hdf5(folder.write("no.h5", "t,x,y,z\n")));
  EXPECT_FALSE(is_hdf5(folder / "absent.h5"));
}

}  // namespace
}  // namespace argil::hdf5
