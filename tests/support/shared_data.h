#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace argil::test {

/// Path of a file of the public data folder that may lie beside the project.
inline std::string shared_data(const std::string& relative) {
  return std::string(ARGIL_SHARED_DATA) + "/" + relative;
}

}  // namespace argil::test

/// Skips the running test, with a word, when a file of the public data folder is absent.
#define ARGIL_NEED_SHARED_DATA(relative)                              \
  if (!std::filesystem::exists(::argil::test::shared_data(relative))) \
  GTEST_SKIP() << "needs " << (relative) << " of the public data folder, which is not beside the project"
