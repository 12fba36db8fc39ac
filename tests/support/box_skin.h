#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::test {

/// Surface of a box: n×n squares of two triangles each on top and bottom, n×max(1, n/2) on the other faces.
inline mesh::TriangleMesh make_box_skin(int n, const Vec3& corner, const Vec3& size) {
  const std::array<int, 3> count = {n, n, std::max(1, n / 2)};
  std::map<std::array<int, 3>, int> number;
  std::vector<Vec3> x;
  std::vector<Eigen::Vector3i> triangles;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = number.emplace(at, static_cast<int>(x.size()));
    const auto share = [&](std::size_t k) { return static_cast<double>(at[k]) / count[k]; };
    if (is_new) x.push_back(corner + size.cwiseProduct(Vec3(share(0), share(1), share(2))));
    return found->second;
  };
  for (std::size_t a = 0; a < 3; ++a)
    for (int side = 0; side < 2; ++side) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      std::array<int, 3> at{};
      at[a] = side * count[a];
      for (int i = 0; i < count[b]; ++i)
        for (int j = 0; j < count[c]; ++j) {
          std::array<int, 4> v{};
          for (std::size_t k = 0; k < 4; ++k) {
            at[b] = i + (k == 1 || k == 2 ? 1 : 0);
            at[c] = j + (k >= 2 ? 1 : 0);
            v[k] = vertex(at);
          }
          if (side == 0) std::swap(v[1], v[3]);  // outward
          triangles.emplace_back(v[0], v[1], v[3]);
          triangles.emplace_back(v[1], v[2], v[3]);
        }
    }
  mesh::TriangleMesh skin;
  skin.vertices.resize(3, static_cast<Eigen::Index>(x.size()));
  skin.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < x.size(); ++i) skin.vertices.col(static_cast<Eigen::Index>(i)) = x[i];
  for (std::size_t i = 0; i < triangles.size(); ++i)
    skin.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return skin;
}

}  // namespace argil::test
