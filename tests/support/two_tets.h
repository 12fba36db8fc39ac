#pragma once

#include "mesh/tet_mesh.h"

namespace argil::test {

/// Vertices (0,0,0) (1,0,0) (0,1,0) (0,0,1) (1,1,1); tets 0 1 2 3 and 1 2 3 4; volumes 1/6 and 1/3.
inline mesh::TetMesh make_two_tets() {
  mesh::TetMesh mesh;
  mesh.vertices = Points{{0, 1, 0, 0, 1}, {0, 0, 1, 0, 1}, {0, 0, 0, 1, 1}};
  mesh.tets = Tets{{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  return mesh;
}

}  // namespace argil::test
