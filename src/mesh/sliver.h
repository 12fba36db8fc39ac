#pragma once

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Flattens a tet in the body, near the top of its axis, to see what a sliver does to a method: a vertex
/// within the body moves towards the opposite face until the height is `share` of what it was, 0 < share < 1.
/// So do its tets whose faces lie in the same plane; the others grow. The body's surface and volume stay.
/// Throws InputError when no vertex can.
void flatten_tet(TetMesh& mesh, double share);

}  // namespace argil::mesh
