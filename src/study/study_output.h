#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenario/scenario.h"
#include "study/cases.h"
#include "study/outcome.h"

namespace argil::study {

using Settings = std::vector<scenario::Setting>;

/// How a study was called.
struct StudyOptions {
  std::string study;   ///< STUDY.json
  std::string output;  ///< table without suffix; empty: the study's name in the working folder
  CaseOptions cases;   ///< folder empty: the table's name with .runs
};

/// Fills in the names that the user left out.
void name_outputs(StudyOptions& options);

/// Provenance of a study's table: what was asked, of which scene and inputs (of `results`), by which build,
/// on which machine.
std::vector<std::pair<std::string, std::string>> describe_study(const std::string& study,
                                                                const std::string& about,
                                                                const std::string& scenario,
                                                                const Settings& settings,
                                                                const std::vector<CaseResult>& results);

/// Refuses a table under whose name the study lies, or a file that the scene reads with one of these
/// settings. Throws InputError.
void check_outputs(const StudyOptions& options, const std::string& scenario,
                   const std::vector<Settings>& settings);

/// Rows that say nothing of a method make a study one to be run again: says how many there are, and when all
/// were refused, which leaves nothing to look at. kDone without any, else kRunFailed.
int print_accidents(const std::string& study, const std::vector<Outcome>& outcomes);

/// a, then b, which wins.
Settings join(const Settings& a, const Settings& b);

/// "/a/b=1 /c=2"
std::string print_settings(const Settings& settings);

}  // namespace argil::study
