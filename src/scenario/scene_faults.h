#pragma once

#include "scenario/faults.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Adds what is wrong beside the keys of a scenario that will not run. Throws IoError.
using FaultFinder = void (*)(const Scenario&, Faults&);

/// What is wrong with tool, motion and body, as far as the keys say how they are: the most that can be said.
/// find_file_faults says less and needs less of the program.
void find_scene_faults(const Scenario& scenario, Faults& faults);

/// load_scenario and load_text, whose refusals name what `find_more` finds, too.
Scenario load_scenario(const std::string& file, const std::vector<Setting>& settings, MotionSource motion,
                       FaultFinder find_more);
Scenario load_text(const std::string& text, const std::string& file, const std::vector<Setting>& settings,
                   MotionSource motion, FaultFinder find_more);

}  // namespace argil::scenario
