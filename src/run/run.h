#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "scenario/build.h"

namespace argil::run {

/// How `argil run` was called.
struct RunOptions {
  std::string scenario;
  std::string text;    ///< the scenario itself, which lies in no file then: `scenario` stands for it
  std::string trace;   ///< replaces /trace/file when not empty
  std::string output;  ///< result file; empty: the scenario's name with .h5 in the working folder
  std::vector<std::string> patches;   ///< --patch files: below the settings
  std::vector<std::string> settings;  ///< --set texts
  int threads = 1;                    ///< 1 to kMostThreads
  bool resume = false;                ///< go on from the result file's checkpoint where there is one
  bool writes_xdmf = true;
  bool dry_run = false;  ///< check and build everything, run and write nothing
  bool quiet = false;
  bool has_own_hand = false;                   ///< a device or a program gives the motion: /trace need not
  bool strict = false;                         ///< /dynamics/strict
  std::vector<std::string> notes;              ///< for the user, beside the scene's
  bool is_planned = false;                     ///< /fidelity/accuracy has been looked after
  std::string asked_run_id;                    ///< then: Identity::id() of the run that was asked for
  std::string remedy = "go on with --resume";  ///< of a run that was stopped or found no room, in its message
};

inline constexpr int kMostThreads = 256;

/// As a shell reads it.
std::string quote_word(const std::string& word);

/// Scenario, patches, settings and trace of a call as words of a shell, for the command that a message asks
/// for.
std::string repeat_words(const RunOptions& options);

/// Exit codes of the program.
enum ExitCode : int {
  kDone = 0,
  kInputRefused = 2,
  kRunFailed = 3,
  kIoFailed = 4,
  kDifferent = 5,
  kInterrupted = 130,
};

/// Loads and checks a scenario with the options' settings and trace.
scenario::Scenario load(const RunOptions& options);

/// Throws InputError where a scenario has ticks and no motion.
void require_motion(const scenario::Scenario& s, const std::string& remedy);

/// The result file's name, given or made of the scenario's.
std::string name_result(const scenario::Scenario& s, const RunOptions& options);

/// What the user should know of a scene, on standard error.
void print_notes(const scenario::Scene& scene, const RunOptions& options);

/// How a run ended.
struct RunEnd {
  int code = kDone;                ///< kDone, kRunFailed, kInterrupted; of a session's replay also kDifferent
  std::string message;             ///< one line that says why it is not done
  std::optional<Failure> failure;  ///< of kRunFailed
};

/// Runs a scenario, which load() gave for these options, from start, or with `resume` from its last
/// checkpoint, to end and writes its result file and XDMF. A resumed run leaves the same bits as one that was
/// never killed. The file is complete up to the last tick also where the run failed or was interrupted.
/// Throws InputError before anything is written, IoError.
RunEnd run_loaded(const scenario::Scenario& s, const RunOptions& options);

/// Loads, runs and prints why it is not done. Returns the exit code.
int run(const RunOptions& options);

}  // namespace argil::run
