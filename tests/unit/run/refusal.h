#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "run/run.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::test {

/// Running `scenario` with these --set texts throws an InputError whose message holds all `parts`, and writes
/// nothing.
inline void expect_refused(const TempFolder& folder, const std::string& scenario,
                           const std::vector<std::string>& settings, const std::vector<std::string>& parts) {
  run::RunOptions options;
  options.quiet = true;
  options.scenario = write_text(folder / "scene.json", scenario);
  options.output = folder / "out.h5";
  options.settings = settings;
  try {
    run::run(options);
    ADD_FAILURE() << "was not refused";
  } catch (const InputError& error) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << part << "\nis not in\n"
                                                                         << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(options.output));
}

}  // namespace argil::test
