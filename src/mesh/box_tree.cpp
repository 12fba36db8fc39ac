#include "mesh/box_tree.h"

namespace argil::mesh {

Points compute_centroids(const Points& vertices, const Triangles& triangles) {
  Points centroids(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    centroids.col(t) =
        (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) + vertices.col(triangles(2, t))) / 3.0;
  return centroids;
}

std::size_t halve_by_centroid(std::span<int> list, const Points& centroids) {
  Box box;
  for (const int t : list) box.include(Vec3(centroids.col(t)));
  Eigen::Index axis = 0;
  (box.high - box.low).maxCoeff(&axis);
  const std::size_t half = list.size() / 2;
  std::nth_element(
      list.begin(), list.begin() + static_cast<std::ptrdiff_t>(half), list.end(), [&](int a, int b) {
        return centroids(axis, a) != centroids(axis, b) ? centroids(axis, a) < centroids(axis, b) : a < b;
      });
  return half;
}

}  // namespace argil::mesh
