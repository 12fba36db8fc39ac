#include "study/study_output.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "run/files.h"
#include "run/identity.h"
#include "run/run.h"

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

/// Lines "POINTER SHA-256" of all runs, each once.
std::string list_inputs(const std::vector<CaseResult>& results) {
  std::set<std::string> lines;
  for (const CaseResult& result : results) {
    std::istringstream text(result.inputs);
    for (std::string line; std::getline(text, line);) lines.insert(line);
  }
  std::string list;
  for (const std::string& line : lines) list += line + ";";
  return list;
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
                                                                const Settings& settings,
                                                                const std::vector<CaseResult>& results) {
  namespace fs = std::filesystem;
  std::string build = run::describe_build();
  std::replace(build.begin(), build.end(), '\n', ';');
  return {{"about", about},
          {"study", fs::path(study).filename().string()},
          {"study_sha256", run::hash_file(study)},
          {"scenario", fs::path(scenario).filename().string()},
          {"scenario_sha256", run::hash_file(scenario)},
          {"inputs_sha256", list_inputs(results)},
          {"settings", print_settings(settings)},
          {"build", build},
          {"machine",
           find_processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads"}};
}

void check_outputs(const StudyOptions& options, const std::string& scenario,
                   const std::vector<Settings>& settings) {
  std::vector<std::string> tables;  // that are there and would be overwritten
  for (const char* ending : {".csv", ".h5"})
    if (std::filesystem::exists(options.output + ending)) tables.push_back(options.output + ending);
  if (tables.empty()) return;
  for (const std::string& table : tables) run::require_other_file(table, options.study, "the study");
  for (const Settings& some : settings) {
    std::optional<scenario::Scenario> s;
    try {
      s = run::load(make_run_options(scenario, some));
    } catch (const InputError&) {  // a run that is refused reads nothing
      continue;
    }
    for (const std::string& table : tables) run::require_no_input(*s, table);
  }
}

int print_accidents(const std::string& study, const std::vector<Outcome>& outcomes) {
  const auto killed = std::count(outcomes.begin(), outcomes.end(), Outcome::killed);
  const auto unknown = std::count(outcomes.begin(), outcomes.end(), Outcome::unknown);
  if (killed > 0)
    std::fprintf(stderr, "argil: %td runs of %s were killed or could not write: start it again\n", killed,
                 study.c_str());
  if (unknown > 0)
    std::fprintf(stderr,
                 "argil: %td runs of %s have no reference to compare with: see their reason in the table\n",
                 unknown, study.c_str());
  const bool is_all_refused =
      !outcomes.empty() && std::count(outcomes.begin(), outcomes.end(), Outcome::refused) ==
                               static_cast<std::ptrdiff_t>(outcomes.size());
  if (is_all_refused)
    std::fprintf(stderr, "argil: all %zu runs of %s were refused: see their reason in the table\n",
                 outcomes.size(), study.c_str());
  return killed + unknown > 0 || is_all_refused ? run::kRunFailed : run::kDone;
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
