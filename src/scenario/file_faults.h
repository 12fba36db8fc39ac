#pragma once

#include "scenario/faults.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Reads the files of a scenario that will not run, as far as its keys say how, and adds what is wrong with
/// them. Throws IoError.
void find_file_faults(const Scenario& scenario, Faults& faults);

}  // namespace argil::scenario
