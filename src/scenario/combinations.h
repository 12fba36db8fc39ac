#pragma once

#include "scenario/faults.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Adds the combinations of keys that cannot run, each valid alone; warns of those that have no effect, and
/// writes what follows from others: the touched surface, the grip's strength, the extent, the axis at unit
/// length.
void check_combinations(Scenario& scenario, Faults& faults);

}  // namespace argil::scenario
