#pragma once

#include <vector>

#include "base/types.h"

namespace argil::contact {

/// Vertices, edges and faces of a triangle surface, and who lies beside whom. Each vertex and each edge is
/// owned by the lowest triangle that has it, so that a pair of triangles tests a pair of features once.
struct SurfaceFeatures {
  SurfaceFeatures(const Triangles& triangles, int num_vertices);

  Triangles triangles;
  Eigen::Matrix2Xi edges;           ///< vertex numbers, lower first; edges in increasing order
  Triangles triangle_edges;         ///< edges (01, 12, 20) of each triangle
  Eigen::Matrix2Xi edge_triangles;  ///< the two triangles of each edge (the first twice at an open boundary)
  Eigen::Matrix2Xi edge_opposite;   ///< the third vertex of each of these
  std::vector<int> vertex_owner;    ///< triangle that owns each vertex; −1: no triangle has it
  std::vector<int> edge_owner;      ///< triangle that owns each edge
  std::vector<int> fan_begin, fan;  ///< triangles around each vertex, increasing
  std::vector<int> ring_begin, ring;  ///< triangles that share a vertex with each triangle, itself left out
  std::vector<int> parts;             ///< the first triangle of each part that no edge joins to another
};

}  // namespace argil::contact
