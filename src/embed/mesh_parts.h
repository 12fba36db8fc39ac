#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Of each tet, the number from 0 of the part of the mesh that hangs together with it by faces.
std::vector<int> label_parts(const mesh::TetMesh& mesh);

/// Of a mesh whose parts do not hang together: that with the most tets, of several the first.
mesh::TetMesh take_largest_part(const mesh::TetMesh& mesh);

}  // namespace argil::embed
