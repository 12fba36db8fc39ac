#pragma once

#include <string>

#include "output/result_file.h"
#include "run/identity.h"
#include "scenario/build.h"
#include "sim/simulation.h"

namespace argil::run {

/// κ of the pressure law over the touched surface at the start, for a person: given or chosen, median and
/// range [Pa/m]; empty with another law.
std::string describe_contact_stiffness(const sim::BodySide& body, const contact::ContactParams& params);

/// What a result says before its first record.
output::ResultHeader make_header(const scenario::Scenario& s, const sim::Simulation& simulation,
                                 const scenario::Scene& scene, const mesh::TriangleMesh& tool,
                                 const Identity& identity);

/// Refuses a motion that begins in the body: says where and how deep, with the file and place that the motion
/// comes from. Throws InputError.
void require_free_start(const sim::Simulation& simulation, mesh::TriangleMesh tool, const std::string& file,
                        const std::string& place, const std::string& remedy);

}  // namespace argil::run
