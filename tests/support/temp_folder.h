#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT: mkdtemp is POSIX

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace argil::test {

/// A new, empty folder that is removed with everything in it.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "argil_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no temporary folder " << name;
    m_path = name;
  }
  ~TempFolder() { std::filesystem::remove_all(m_path); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  std::string operator/(const std::string& name) const { return (m_path / name).string(); }

  /// Writes a file of this content and gives its path.
  std::string write(const std::string& name, const std::string& content) const {
    std::filesystem::remove(m_path / name);  // some file systems flush to disk when a file is written over
    std::ofstream(m_path / name, std::ios::binary) << content;
    return *this / name;
  }
  static std::string read(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

 private:
  std::filesystem::path m_path;
};

}  // namespace argil::test

/// The statement throws `type` and its message contains `words`.
#define ARGIL_EXPECT_THROW_WITH(statement, type, words)                                                 \
  try {                                                                                                 \
    statement;                                                                                          \
    ADD_FAILURE() << "nothing thrown by " #statement;                                                   \
  } catch (const type& error) {                                                                         \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << "message: " << error.what(); \
  }
