#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

/// Every scheme and its word in scenarios, probes and messages.
const std::vector<std::pair<material::Scheme, std::string>>& scheme_names();

/// What of the clay a run can meet.
struct ClayRange {
  double softest = 0.0;        ///< smallest dry Young's modulus [Pa]
  double stiffest = 0.0;       ///< largest [Pa]
  double initially_wet = 0.0;  ///< largest saturation at the start [–]
};

/// Does it take the mesh's fields to know that range?
bool needs_fields(const Scenario& scenario);

/// Where the effective medium stands over every φ and every dry modulus that the run can reach.
struct MediumCheck {
  std::string status;   ///< in words
  std::string warning;  ///< empty, or what to tell the user
};

/// Throws InputError where C is not positive definite or where 4-node tets would lock. The largest φ is the
/// porosity where the tool can give water, that is with a wet (or the trace's) mode and an uptake above 0;
/// else that of the wettest clay at the start, for diffusion raises S nowhere above it. The moduli are those
/// at both ends of the range: every scheme's C/E depends on K_I/E alone, and its failure goes one way with
/// it.
MediumCheck check_effective_medium(const Scenario& scenario, const ClayRange& range);

}  // namespace argil::scenario
