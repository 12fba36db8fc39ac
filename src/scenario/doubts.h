#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

/// What a scenario may say but hardly means, a line each with the remedy: nothing held, clay that never
/// flows, a number that is of another unit.
std::vector<std::string> list_doubts(const Scenario& scenario);

}  // namespace argil::scenario
