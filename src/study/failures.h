#pragma once

#include <string>

#include "study/stability_map.h"

namespace argil::study {

/// Writes for each way to fail on a map (all outcomes but accurate) the smallest scenario that still ends so,
/// from the place that is nearest to a boundary, to FOLDER/STUDY_OUTCOME.json. One after another, and again
/// until none of them keeps the failure, or a bounded number of runs is spent: a shorter motion, fewer tets
/// of a body that argil makes, the scene's own value for what the study sets. What ends early is cut off
/// after the tick of its failure. A smaller one takes no more steps times tets, fails by the same outcome and
/// exit code, and where it reaches its end as far beyond the bound, under half the force or more: the first
/// touch of a tool is another failure. A refused one is that of a place that was accepted, with the settings
/// that were not. Throws IoError, Interrupted.
void write_failures(const StabilityMap& map, const std::string& folder);

}  // namespace argil::study
