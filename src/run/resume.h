#pragma once

#include <string>

#include "base/archive.h"
#include "run/identity.h"

namespace argil::run {

/// Where an earlier run of the same came to.
struct ResumePoint {
  enum class Kind {
    none,        ///< no file, or none with a checkpoint: begin anew
    checkpoint,  ///< go on from `state`
    done,        ///< nothing is left to do
  };
  Kind kind = Kind::none;
  Snapshot state;
};

/// Looks for it in RESULT. Throws InputError, naming what differs, when RESULT is of another scenario, other
/// inputs or another build; IoError when it cannot be read or is being written.
ResumePoint find_resume_point(const std::string& result, const Identity& identity);

}  // namespace argil::run
