#pragma once

#include <string>
#include <vector>

#include "contact/approach.h"
#include "scenario/build.h"

namespace argil::run {

/// The tool at the start of a run and at the end of each tick, where the trace has it.
std::vector<contact::Pose> list_poses(const scenario::Scenario& s, const device::Trace& trace);

/// Finds how near the scene's tool comes to the surface that it can touch, at rest.
contact::ApproachFinder make_approach_finder(const scenario::Scenario& s, const scenario::Scene& scene);

/// For the user: how far a motion stays away from the body at rest, when it is nearest, and what mends it.
/// `given_trace`: the one that stands in for the scenario's; empty: none.
/// Empty where it touches the body, and where a simulated hand may leave the trace.
std::string describe_miss(const scenario::Scenario& s, const scenario::Scene& scene,
                          const std::string& given_trace);

}  // namespace argil::run
