#pragma once

#include <span>
#include <vector>

#include "contact/contact.h"
#include "contact/tool_solid.h"
#include "mesh/tet_mesh.h"
#include "sim/state.h"

namespace argil::scenario {

/// Places of a body at rest that a tool of any shape covers on its way, each in the middle of a disc of the
/// surface that is covered to three quarters, and where that is largest. Those of one moment lie along an
/// edge in a row and round a rim in a ring. Their radius is that of Hertz's patch of a ball that covers as
/// much: √(R d) of √(2 R d). In order of time. Empty where the tool covers nothing. `surface`: outward.
std::vector<sim::TouchedPlace> find_covered_places(std::span<const contact::Pose> poses,
                                                   contact::ToolSolid tool,
                                                   const mesh::TriangleMesh& surface);

}  // namespace argil::scenario
