#pragma once

// Rows of the parameter table that say how the tool moves.

#include <string>

#include "scenario/binding.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// `/trace`; file names are relative to `folder`.
void bind_trace(Binder& b, TraceSpec& t, const std::string& folder);

/// `/hand`.
void bind_hand(Binder& b, HandSpec& hand);

}  // namespace argil::scenario
