#pragma once

#include <string>
#include <vector>

#include "run/run.h"
#include "scenario/scenario.h"

namespace argil::study {

/// One run of a study: a scenario with settings.
struct Case {
  std::string scenario;
  std::vector<scenario::Setting> settings;  ///< later ones win
  int repeats = 1;                          ///< times that it runs, for its cost
};

/// How a case ended and what it cost.
struct CaseResult {
  std::string inputs;  ///< Identity::inputs: hashes of the files that it reads; empty when refused
  std::string id;      ///< hash of scenario, trace, meshes and build: equal ids give equal bits
  int exit_code = 0;   ///< of `argil run`; above 128: killed by that signal less 128
  std::string reason;  ///< why it was refused or failed; empty when done
  std::string file;    ///< its result; empty when refused
  std::vector<double>
      cpu_seconds;               ///< of the ticks alone, of all passes of a run to an accuracy; one a repeat
  double peak_memory_MiB = 0.0;  ///< of the process
  double instructions = 0.0;     ///< in user mode, of the ticks; 0: the machine does not count them
};

struct CaseOptions {
  std::string folder;                      ///< where results are kept
  std::string program = "/proc/self/exe";  ///< the argil that runs them
  int jobs = 1;                            ///< runs at a time
  bool quiet = false;
};

/// Options of `argil run` for a scenario with settings.
run::RunOptions make_run_options(const std::string& scenario, const std::vector<scenario::Setting>& settings);

/// Can a run that ended with this code end otherwise another time? Killed, or without room to write.
bool is_accident(int exit_code);

/// Runs cases, each in a process of its own and in one thread, and keeps what comes out under the case's id:
/// one that was finished before is not run again, but for accidents. Processes end with this one. Results
/// stand in the order of the cases, whatever order they ended in. Throws IoError when the folder cannot be
/// written, and Interrupted after SIGINT or SIGTERM, when all that ran have been told to end and have ended;
/// a case that fails is a result.
std::vector<CaseResult> run_cases(const std::vector<Case>& cases, const CaseOptions& options);

/// Throws Interrupted when the study was told to end: between its runs.
void check_interrupt(const CaseOptions& options);

/// Median of the CPU seconds of a case; 0 when it has none.
double compute_median_cpu(const CaseResult& result);

}  // namespace argil::study
