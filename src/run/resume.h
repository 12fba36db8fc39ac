#pragma once

#include <optional>
#include <string>

#include "base/archive.h"
#include "run/identity.h"
#include "sim/state.h"

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
  std::optional<sim::Body> cells;  ///< that the body had got before it, of ResultReader::find_last_cells
};

/// Looks for it in RESULT. Throws InputError, naming what differs, when RESULT is of another scenario, other
/// inputs or another build; IoError when it cannot be read or is being written.
ResumePoint find_resume_point(const std::string& result, const Identity& identity);

}  // namespace argil::run
