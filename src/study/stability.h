#pragma once

#include "study/study_output.h"

namespace argil::study {

/// Where methods fail: runs a stability study over its grid, finds by bisection along x where a run becomes
/// wrong or unstable, and writes STEM.csv and STEM.h5, a row a run and a row a boundary. With `failures`, a
/// folder, each way to fail leaves its smallest scenario there (failures.h). Returns kDone, or
/// kRunFailed where runs say nothing of the method (print_accidents). Throws
/// InputError, IoError, Interrupted.
int map_stability(StudyOptions options, const std::string& failures);

}  // namespace argil::study
