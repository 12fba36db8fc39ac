#pragma once

#include "mesh/tet_mesh.h"

namespace argil::test {

/// Box [0, lx]×[0, ly]×[0, lz] of nx×ny×nz cells, each cut into six tets around a diagonal, neighbours
/// mirrored. With cubic cells all tets are congruent (alcoves of the reflection group C̃₃) and every pair that
/// shares a face is mirrored in it, as are the walls: centroids lie exactly opposite each other.
inline mesh::TetMesh make_mirrored_block(int nx, int ny, int nz, const Vec3& size) {
  mesh::TetMesh mesh;
  mesh.vertices.resize(3, (nx + 1) * (ny + 1) * (nz + 1));
  const auto id = [&](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        mesh.vertices.col(id(i, j, k)) = Vec3(size.x() * i / nx, size.y() * j / ny, size.z() * k / nz);
  constexpr int kSteps[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  mesh.tets.resize(4, 6 * nx * ny * nz);
  Eigen::Index t = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (const auto& steps : kSteps) {
          const int cell[3] = {i, j, k};
          int at[3] = {i + i % 2, j + j % 2, k + k % 2};
          int corner[4] = {id(at[0], at[1], at[2]), 0, 0, 0};
          for (int s = 0; s < 3; ++s) {
            at[steps[s]] += cell[steps[s]] % 2 == 0 ? 1 : -1;
            corner[s + 1] = id(at[0], at[1], at[2]);
          }
          const double volume =
              mesh::compute_tet_volume(mesh.vertices.col(corner[0]), mesh.vertices.col(corner[1]),
                                       mesh.vertices.col(corner[2]), mesh.vertices.col(corner[3]));
          if (volume < 0.0) std::swap(corner[1], corner[2]);
          for (int c = 0; c < 4; ++c) mesh.tets(c, t) = corner[c];
          ++t;
        }
  return mesh;
}

}  // namespace argil::test
