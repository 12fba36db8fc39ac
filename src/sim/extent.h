#pragma once

#include <optional>
#include <vector>

#include "sim/params.h"
#include "solid/supports.h"

namespace argil::sim {

/// Why steps must solve for the whole body, and what to change for a region: ends of sentences for the user.
struct RegionObstacle {
  const char* reason;
  const char* remedy;
};

/// Nothing where steps in time can be restricted to the region that moves. Friction is an obstacle to an
/// `automatic` extent only.
std::optional<RegionObstacle> find_region_obstacle(const Params& params,
                                                   const std::vector<solid::Support>& supports);

/// Do the steps of a body with `num_free` free nodes solve for the region that moves? The one place that
/// decides on it: `local` and `whole` as asked for, `automatic` by fidelity, obstacles and size.
bool restricts_to_region(const Params& params, const std::vector<solid::Support>& supports, int num_free);

}  // namespace argil::sim
