#pragma once

#include "mesh/tet_mesh.h"
#include "mesh/topology.h"

namespace argil::embed {

/// Moves the boundary of a body onto a surface that it follows roughly, as far as tets keep their shape, and
/// vertices inside to where the shapes around them are better. Facets enclose as much as the surface does,
/// also in parts that are a few of them round. No tet gets a mean ratio below 0.25 that had none, and none
/// that had loses some.
void lay_on_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, mesh::TetMesh& body);

}  // namespace argil::embed
