#include "study/study_output.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>

#include "study/files.h"
#include "study/identity.h"
#include "study/run.h"

namespace argil::study {
namespace {

/// Name of the first processor, as Linux gives it.
std::string find_processor() {
  std::ifstream in("/proc/cpuinfo");
  std::string line;
  while (std::getline(in, line))
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

}  // namespace

void name_outputs(StudyOptions& options) {
  namespace fs = std::filesystem;
  if (options.output.empty()) options.output = fs::path(options.study).stem().string();
  if (options.cases.folder.empty()) options.cases.folder = options.output + ".runs";
}

std::vector<std::pair<std::string, std::string>> describe_study(const std::string& study,
                                                                const std::string& about,
                                                                const std::string& scenario,
                                                                const Settings& settings) {
  namespace fs = std::filesystem;
  RunOptions options;
  options.scenario = scenario;
  std::string inputs = find_identity(load(options)).inputs;
  std::replace(inputs.begin(), inputs.end(), '\n', ';');
  std::string build = describe_build();
  std::replace(build.begin(), build.end(), '\n', ';');
  return {{"about", about},
          {"study", fs::path(study).filename().string()},
          {"study_sha256", hash_file(study)},
          {"scenario", fs::path(scenario).filename().string()},
          {"scenario_sha256", hash_file(scenario)},
          {"inputs_sha256", inputs},
          {"settings", print_settings(settings)},
          {"build", build},
          {"machine",
           find_processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads"}};
}

Settings join(const Settings& a, const Settings& b) {
  Settings all = a;
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

std::string print_settings(const Settings& settings) {
  std::string text;
  for (const scenario::Setting& s : settings) text += (text.empty() ? "" : " ") + s.pointer + "=" + s.value;
  return text;
}

}  // namespace argil::study
