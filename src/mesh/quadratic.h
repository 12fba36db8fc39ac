#pragma once

#include "mesh/topology.h"

namespace argil::mesh {

using QuadraticTets = Eigen::Matrix<int, 10, Eigen::Dynamic>;      ///< 10×m node numbers, corners first
using QuadraticTriangles = Eigen::Matrix<int, 6, Eigen::Dynamic>;  ///< 6×b node numbers, corners first

/// The six edges of a tet by its corners, in the order of nodes 4 … 9 of a 10-node tet (that of C3D10 and of
/// VTK).
inline constexpr int kTetEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

/// Four points of integration, of degree 2 [Hammer1956]: one barycentric coordinate of each is far, the
/// others are near.
inline constexpr double kPointFar = 0.58541019662496845446;
inline constexpr double kPointNear = 0.13819660112501051518;

/// Nodes of the 10-node tets over a mesh: its vertices, then one of every edge: the middle, or where
/// `edge_nodes` has it.
struct QuadraticMesh {
  Points nodes;                 ///< 3×(n + edges) [m]; the first n are the vertices
  QuadraticTets tets;           ///< node numbers of each tet
  QuadraticTriangles boundary;  ///< of each boundary face: its corners, then the nodes of 01, 12, 20
};

/// Edges are numbered by the first tet that has them.
QuadraticMesh make_quadratic_mesh(const TetMesh& mesh, const Topology& topology);

using QuadraticNodes = Eigen::Matrix<double, 3, 10>;  ///< of one tet [m]

/// Values of the ten shape functions at barycentric coordinates L: L(2L − 1) at corners, 4 LᵢLⱼ on edges.
Eigen::Matrix<double, 10, 1> compute_quadratic_shape(const Vec4& L);

/// Corners (3×4) of the 4-node tet that moves with L as this one does near L: Σ xᵢ ∂Nᵢ/∂L. Its volume over
/// that of a unit of L is the Jacobian's determinant.
Eigen::Matrix<double, 3, 4> compute_tangent_tet(const QuadraticNodes& nodes, const Vec4& L);

}  // namespace argil::mesh
