#pragma once

#include "scenario/build.h"
#include "scenario/cell_sizes.h"

namespace argil::scenario {

/// Supports and loads of the scenario, with the vertices of its cells: lists number those of the mesh file.
/// Throws InputError with all that names no vertex of the body or holds nothing.
void fix_and_load(const Scenario& s, const Halvings& halvings, Scene& scene);

/// The same check of supports alone, of a body that is not whole: its vertices are.
void check_supports_of_vertices(const Scenario& s, const Scene& scene);

/// An equilibrium has no mass to lean on: the supports alone must hold every part of the body. Throws
/// InputError.
void check_equilibrium_supports(const Scenario& s, const sim::Body& body);

/// In a motion a body may turn or move as a whole, or not at all: a note of how its supports leave it free to, or of
/// supports that hold all of it; empty elsewhere.
std::string describe_free_motion(const Scenario& s, const sim::Body& body);

}  // namespace argil::scenario
