#pragma once

#include "study/study_output.h"

namespace argil::study {

/// Accuracy against cost: runs every point of a chart study and writes STEM.csv and STEM.h5, a row a run.
/// Returns kDone, or kRunFailed when the reference did not come to its end. Throws InputError, IoError,
/// Interrupted.
int chart(StudyOptions options);

/// Prints, as a patch of the scenario (RFC 7396), the settings of the most accurate run whose cost is at most
/// `budget` CPU seconds a simulated second; the table is made or taken as `chart` does.
int chart_budget(StudyOptions options, double budget);

}  // namespace argil::study
