#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/types.h"

namespace argil::mesh {

/// Triangle surface. Closed surfaces are oriented with the normal pointing out.
struct TriangleMesh {
  Points vertices;      ///< 3×n positions [m]
  Triangles triangles;  ///< 3×m vertex numbers
  int num_vertices() const { return static_cast<int>(vertices.cols()); }
  int num_triangles() const { return static_cast<int>(triangles.cols()); }
};

/// A node of ten-node tets that is off the middle of its edge, where the body's surface bends.
struct EdgeNode {
  int a = 0, b = 0;           ///< ends of the edge, a < b
  Vec3 place = Vec3::Zero();  ///< [m] at rest
};

/// Tetrahedral body at rest, with the fields its file carried.
struct TetMesh {
  Points vertices;                           ///< 3×n rest positions [m]
  Tets tets;                                 ///< 4×m vertex numbers; det(x1−x0, x2−x0, x3−x0) > 0
  std::map<std::string, Field> cell_fields;  ///< scalar data per tet found in the file, by its name there
  std::vector<int> numbers = {};             ///< of the tets in the file; empty: their own
  std::vector<EdgeNode> edge_nodes = {};     ///< by a, then b; of all other edges the middle is the node
  int num_vertices() const { return static_cast<int>(vertices.cols()); }
  int num_tets() const { return static_cast<int>(tets.cols()); }
  /// What a tet is called in the file, in messages and in results.
  int number(int tet) const { return numbers.empty() ? tet : numbers[static_cast<std::size_t>(tet)]; }
};

/// Signed volume [m³] of the tet with corners a, b, c, d; positive when d lies on the side of (b−a)×(c−a).
inline double compute_tet_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6.0;
}

/// Normal of the triangle with those three corners, out of a closed surface and as long as its area [m²].
template <class Corners>
Vec3 compute_area_vector(const Points& x, const Corners& corners) {
  const Vec3 a = x.col(corners[0]);
  return 0.5 * Vec3(x.col(corners[1]) - a).cross(Vec3(x.col(corners[2]) - a));
}

}  // namespace argil::mesh
