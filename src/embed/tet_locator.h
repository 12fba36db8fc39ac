#pragma once

#include <array>
#include <vector>

#include "embed/triangle_tree.h"
#include "mesh/curved.h"
#include "mesh/topology.h"

namespace argil::embed {

/// Finds the tet of a mesh that contains a point, by a uniform grid of boxes that list the tets reaching into
/// them. Of tets with bent edges the straight ones are looked at; weights are those of the bent one, and may
/// then be a little negative.
class TetLocator {
 public:
  explicit TetLocator(const mesh::TetMesh& mesh);

  struct Place {
    int tet = -1;                 ///< −1: outside
    Vec4 weights = Vec4::Zero();  ///< barycentric
  };

  /// Lowest tet with all weights of x at or above −1e-10, so that no point falls between two tets by
  /// round-off.
  Place find(const Vec3& x) const;
  /// The same; of a point outside, the near tet whose weights have the highest minimum, then negative but at
  /// or above −`beyond`: by so much of its height the point lies beyond a face. −1: none is so near.
  Place find_near(const Vec3& x, double beyond) const;

 private:
  std::array<int, 3> box(const Vec3& x) const;
  std::size_t box_index(const Vec3& x) const;
  Vec4 compute_weights(int tet, const Vec3& x) const;
  Place find_straight(const Vec3& x) const;

  Points m_vertices;
  Tets m_tets;
  std::vector<std::array<Vec3, 2>> m_bounds;  // of each tet, a little wider
  Vec3 m_lower;
  double m_box_size = 1.0;
  std::array<int, 3> m_counts = {1, 1, 1};
  std::vector<int> m_begin;  // per box: where its tets begin
  std::vector<int> m_list;   // tets, increasing in each box
  mesh::CurvedTets m_curved;
};

/// Finds for points outside a mesh the tet below the nearest place of the boundary.
class BoundaryTets {
 public:
  explicit BoundaryTets(const mesh::TetMesh& mesh) : BoundaryTets(mesh, mesh::make_topology(mesh)) {}
  /// −1: farther than `farthest` [m], or than `most_beyond` times the longest edge of that tet. Weights are
  /// negative or above 1.
  TetLocator::Place find(const Vec3& x, double most_beyond, double farthest) const;

 private:
  BoundaryTets(const mesh::TetMesh& mesh, const mesh::Topology& topology);

  Points m_vertices;
  Tets m_tets;
  std::vector<int> m_boundary_tet;
  TriangleTree m_boundary;
  mesh::CurvedTets m_curved;
};

/// Barycentric weights of x in the tet a, b, c, d; they sum to 1 and are negative beyond a face.
Vec4 compute_barycentric_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& x);

}  // namespace argil::embed
