#pragma once

#include <string>

#include "run/run.h"

namespace argil::run {

/// What `argil plan` is given.
struct PlanOptions {
  RunOptions run;      ///< what it reads of a run; its scenario has /fidelity/accuracy
  std::string output;  ///< file of the patch; empty: standard output
};

/// Runs a recorded motion to /fidelity/accuracy as `run` does, and writes what was chosen as a patch of the
/// scenario, for runs and live sessions that move alike: element, cells, step. The result is not kept.
/// Returns an exit code. Throws InputError where the motion touches nothing, from which no cells follow.
int plan(const PlanOptions& options);

}  // namespace argil::run
