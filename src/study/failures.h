#pragma once

#include <string>

#include "study/stability_map.h"

namespace argil::study {

/// Writes for each way to fail on a map (all outcomes but accurate) the smallest scenario that still ends so,
/// from the place that is nearest to a boundary, to FOLDER/STUDY_OUTCOME.json: cut off after the tick of its
/// failure, else with its duration halved (not where it is wrong, which is judged over a whole motion), and
/// bodies that argil makes with their number of tets halved, for as long as the outcome stays. A refused one
/// is that of a place that was accepted, with the settings that were not. Throws IoError.
void write_failures(const StabilityMap& map, const std::string& folder);

}  // namespace argil::study
