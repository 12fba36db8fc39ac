#pragma once

#include "mesh/tet_mesh.h"
#include "mesh/topology.h"

namespace argil::embed {

/// Moves the boundary of a body onto a surface that it follows roughly, its vertices near sharp edges and
/// corners onto these, as far as tets keep their shape, and vertices inside to where the shapes around them
/// are better. Facets enclose as much as the surface does, also in parts that are a few of them round; where
/// edges are to bend with the surface, their ends lie on it. No tet gets a mean ratio below 0.25 or an angle
/// between faces below 15 or above 165 degrees that had none, and none that had gets worse.
void lay_on_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, bool bends_edges,
                    mesh::TetMesh& body);

/// Before that, where the boundary is off by most of an edge: moves its vertices to the nearest place of the
/// surface, and with them those inside, the less the farther they are, as far as tets keep their shape.
void draw_to_surface(const mesh::TriangleMesh& surface, const mesh::Topology& topology, mesh::TetMesh& body);

/// Moves the boundary out or in, by one share of the edges there, until it encloses as much as `wanted` [m³],
/// as far as tets keep their shape. Where that is more than a tenth of an edge, nothing moves.
void match_volume(double wanted, const mesh::Topology& topology, mesh::TetMesh& body);

}  // namespace argil::embed
