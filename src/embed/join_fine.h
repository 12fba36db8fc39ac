#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Drops vertices of a closed surface where it is finer than asked for and smooth, and those that no triangle
/// uses. The vertices that stay keep their places and their order.
///
/// A vertex goes to the end of its shortest edge where that is shorter than `shortest` at both ends; where no
/// edge becomes longer than twice that, no face turns by more than 30°, and the surface stays within a
/// twelfth of it of every face that was there. `shortest`: of each vertex [m]; a vertex with 0 stays.
mesh::TriangleMesh join_fine(const mesh::TriangleMesh& surface, const Field& shortest);

}  // namespace argil::embed
