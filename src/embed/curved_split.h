#pragma once

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Splits the triangles of a coarse surface where it bends, so that it lies where a smooth surface through
/// its vertices would: an edge whose middle would lie off by more than a hundredth of its length is halved
/// there, twice over at most. The vertices go as far the other way, so that the volume stays: those of facets
/// that were pressed round lie below what pressed them. Middles are those of the cubic curve that starts and
/// ends at right angles to the vertices' normals [Vlachos2001]; edges at which faces meet at 40° and more are
/// sharp and stay straight. Vertices keep their numbers, and others follow.
mesh::TriangleMesh split_where_curved(const mesh::TriangleMesh& surface);

}  // namespace argil::embed
