#pragma once

#include "mesh/tet_mesh.h"

namespace argil::shapes {

/// Hexahedra that meet face to face. Corners 0–3 go counter-clockwise round the lower face seen from above,
/// 4–7 lie above them.
struct HexMesh {
  Points vertices;                                  ///< 3×n [m]
  Eigen::Matrix<int, 8, Eigen::Dynamic> hexahedra;  ///< 8×m vertex numbers
};

/// nx × ny × nz equal boxes that fill the box of edges `size`, bottom at z = 0, centred in x and y.
HexMesh make_box_hexahedra(const Vec3& size, const Eigen::Vector3i& counts);

/// How a cylinder is cut: a square of `core` × `core` cells in the middle, `rings` rings of 4·core cells
/// round it, `layers` along the axis.
struct CylinderCounts {
  int core = 1;
  int rings = 1;
  int layers = 1;
  int num_cells() const { return (core * core + 4 * core * rings) * layers; }
};

/// Cylinder about z, bottom at z = 0; the outermost vertices lie on the true surface.
HexMesh make_cylinder_hexahedra(double radius, double height, const CylinderCounts& counts);

/// Twelve tets a hexahedron: its centre is joined with the neighbour's centre over each edge of the face
/// between them, and with the two halves of each boundary face. No direction is preferred.
mesh::TetMesh split_hexahedra(const HexMesh& mesh);

/// Boundary of the hexahedra, each face in two triangles, normals outward.
mesh::TriangleMesh extract_boundary(const HexMesh& mesh);

}  // namespace argil::shapes
