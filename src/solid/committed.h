#pragma once

#include <vector>

#include "base/archive.h"
#include "base/status.h"
#include "solid/active_region.h"

namespace argil::solid {

// What a body is known to be between two steps: where a step begins, what counts after it, and the return to
// what was before.

/// The next step begins at `state`. Of nodes that sleep all is as it was in the last step. The body keeps a
/// reference to the plastic strain.
void set_start(Body& body, ActiveRegion& region, const SolidState& state);

/// Does ahead of the first step what is done once: memory, and the forces of tets that do not move.
/// `force`: 3×n [N] that act already, of which no node needs to be told.
void make_ready(Body& body, ActiveRegion& region, const SolidState& state, const Points& force);

/// The step that led to `state` counts from now on; it flowed where `is_flowing` is set, of each run of
/// kLanes tets (empty: maybe anywhere).
void commit(Body& body, ActiveRegion& region, const SolidState& state,
            const std::vector<char>& is_flowing = {});

/// What has happened since the last commit never was: `state` and all that steps take from earlier ones are
/// as they were then. Moduli, sizes and masses are to be those of then already.
[[nodiscard]] StepStatus roll_back(Body& body, ActiveRegion& region, SolidState& state, Tick tick);

/// The state is set from outside: nothing is known of what led to it.
void forget(Body& body, ActiveRegion& region);

/// `state` and all that steps take from earlier ones besides moduli, sizes and masses, which come first.
/// After a return kinematics are to be restored.
void serialize(Archive& archive, Body& body, ActiveRegion& region, SolidState& state);

/// After a return: kinematics as those of the saved x were, with frames that lag as far as they did.
StepStatus restore_kinematics(Body& body, const ActiveRegion& region, const Points& x, Tick tick);

}  // namespace argil::solid
