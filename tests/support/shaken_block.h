#pragma once

#include "base/rng.h"
#include "support/block_mesh.h"

namespace argil::test {

/// Block of 0.1 m whose inner vertices are shaken: tets of all shapes, no two centroids opposite each other.
inline mesh::TetMesh make_shaken_block(int n) {
  mesh::TetMesh mesh = make_block(n, n, n, Vec3(0.1, 0.1, 0.1));
  Rng rng(3, "shake");
  const double cell = 0.1 / n;
  for (int v = 0; v < mesh.num_vertices(); ++v)
    for (int c = 0; c < 3; ++c)
      if (double& x = mesh.vertices(c, v); x > 1e-9 && x < 0.1 - 1e-9) x += cell * rng.uniform(-0.2, 0.2);
  return mesh;
}

}  // namespace argil::test
