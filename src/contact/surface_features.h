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
  std::vector<int> vertex_owner;    ///< triangle that owns each vertex; −1: no triangle has it
  std::vector<int> edge_owner;      ///< triangle that owns each edge
  std::vector<int> ring_begin, ring;  ///< triangles that share a vertex with each triangle, itself left out
};

/// Squared distance from `p` to a triangle [m²], and the sign of its side is the caller's business.
double compute_squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// From `face`, steps to neighbouring faces as long as one is nearer to `p`; returns the nearest found. A tie
/// keeps the present one, so that a point that does not move does not change its face.
int walk_to_nearest(const SurfaceFeatures& features, const Points& x, const Vec3& p, int face);

}  // namespace argil::contact
