#pragma once

#include <string>

#include "mesh/topology.h"
#include "solid/elements.h"
#include "solid/supports.h"

namespace argil::solid {

/// A motion without strain that the constraints leave to the body, in words ("the part with node 12 can turn
/// about …"), and how many there are; empty when there is none, and the stiffness of the constrained body is
/// positive definite. Tets that share a face move as one; parts that share an edge or a vertex only are
/// hinged there.
std::string find_rigid_motion(const Elements& elements, const mesh::Topology& topology,
                              const Constraints& constraints);

}  // namespace argil::solid
