#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenario/scenario.h"

namespace argil::run {

/// What a run's bits are a function of, besides the kind of machine.
struct Identity {
  std::string scenario;  ///< SHA-256 of the resolved scenario, files relative to its folder
  std::string inputs;    ///< a line "POINTER SHA-256" for each file that it reads
  std::string build;     ///< describe_build()
  std::string asked_id;  ///< id() of the run that was asked for, where cells were chosen for it; else empty
  /// SHA-256 of the first three.
  std::string id() const;
  /// As a result file keeps it: name → text.
  std::vector<std::pair<std::string, std::string>> provenance() const;
};

/// Reads and hashes every file of the scenario. Throws IoError.
Identity find_identity(const scenario::Scenario& s);

/// Name, version, commit, compiler, flags, libraries: what a numeric result depends on besides its input.
std::string describe_build();

}  // namespace argil::run
