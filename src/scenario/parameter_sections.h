#pragma once

#include <string>

#include "scenario/binding.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Of a body or tool, and, as wide, of metres per unit of a file.
Range size_range();

/// Keys below /body, of which `folder` is that of the scenario.
void bind_body(Binder& b, BodySpec& body, sim::Params& p, const std::string& folder);

/// Keys below /material.
void bind_material(Binder& b, sim::Params& p);

}  // namespace argil::scenario
