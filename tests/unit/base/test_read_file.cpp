// Files come back byte by byte, whatever their kind and length; what cannot be read is named with the
// system's reason.
#include "base/read_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>
#include <thread>

#include "base/error.h"
#include "support/temp_folder.h"

namespace argil {
namespace {

TEST(ReadFile, GivesAllBytesOfFilesAroundTheSizeOfABlock) {
  const test::TempFolder folder;
  for (const std::size_t size : {0U, 1U, 4096U, (1U << 20) - 1, 1U << 20, (1U << 20) + 1, 3000000U}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * i % 251);
    EXPECT_EQ(read_file(folder.write("bytes", bytes)), bytes) << size;
  }
}

TEST(ReadFile, ReadsAPipeToItsEnd) {
  const test::TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string bytes(2500000, 'x');
  std::thread writer([&] { std::ofstream(pipe) << bytes; });
  EXPECT_EQ(read_file(pipe), bytes);
  writer.join();
}

TEST(ReadFile, NamesWhatCannotBeReadWithTheReason) {
  const test::TempFolder folder;
  ARGIL_EXPECT_THROW_WITH(read_file(folder / "none"), IoError, "none: cannot be read: No such file");
  ARGIL_EXPECT_THROW_WITH(read_file(folder / ""), IoError, "cannot be read: Is a directory");
}

}  // namespace
}  // namespace argil
