#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

/// load_scenario of JSON text that lies in no file. `file` stands for it in messages, and need not exist;
/// paths are relative to its folder. Throws InputError.
Scenario load_text(const std::string& text, const std::string& file, const std::vector<Setting>& settings,
                   MotionSource motion = MotionSource::trace);

}  // namespace argil::scenario
