#pragma once

#include <algorithm>
#include <vector>

#include "base/lanes.h"
#include "mesh/quadratic.h"
#include "mesh/topology.h"
#include "solid/parameters.h"

namespace argil::solid {

/// Nodes, integration points and shape functions of every tet at rest; fixed for ever.
struct Elements {
  int nodes_per_tet = 4;          ///< N: 4 or 10
  int points_per_tet = 1;         ///< Q: 1 or 4
  Points rest;                    ///< 3×n nodes [m]; the mesh's vertices come first
  Eigen::MatrixXi nodes;          ///< N×m node numbers, corners first
  Field weight;                   ///< volume of each point [m³], tet by tet; sums to the rest volume
  Eigen::Matrix3Xd gradient;      ///< ∇λ [1/m] of the barycentric coordinates: four columns a point
  Field node_volume;              ///< lumped rest volume of each node [m³]
  Field shape_volume;             ///< ∫Nᵢ dV [m³]: carries body forces; p2's corners below 0
  Eigen::MatrixXd shape_shares;   ///< 10×m: of ∫Nᵢ dV in each tet's volume; empty: no edge is bent
  std::vector<int> node_begin;    ///< n+1: where each node's corners begin in node_corners
  std::vector<int> node_corners;  ///< N·tet + corner of every tet around a node, tets increasing
  Triangles surface;              ///< boundary as flat triangles between nodes, outward
  std::vector<int> numbers;       ///< of the tets in the mesh's file; empty: their own
  int surface_per_face = 1;       ///< of them per boundary face of the mesh, in its order

  int num_tets() const { return static_cast<int>(nodes.cols()); }
  int num_nodes() const { return static_cast<int>(rest.cols()); }
  int num_points() const { return static_cast<int>(weight.size()); }
  int tet_of_point(int point) const { return point / points_per_tet; }
  /// What the tet of a point is called in messages.
  int number_of_point(int point) const {
    const int tet = tet_of_point(point);
    return numbers.empty() ? tet : numbers[static_cast<std::size_t>(tet)];
  }
  /// Share of a tet's mass at its node i in time (p2: diagonal of the consistent mass, 6 and 32 times V/420,
  /// over their sum), and of its body force in statics.
  double mass_share(int i) const { return nodes_per_tet == 4 ? 0.25 : (i < 4 ? 6.0 : 32.0) / 216.0; }
  double shape_share(int tet, int i) const {
    if (shape_shares.size() > 0) return shape_shares(i, tet);
    return nodes_per_tet == 4 ? 0.25 : (i < 4 ? -0.05 : 0.2);
  }
};

using mesh::kPointFar;
using mesh::kPointNear;

/// ∇N [1/m] of the N nodes of a tet at a point, from `gradient`, ∇λ there.
template <int N>
Eigen::Matrix<double, 3, N> find_node_gradients(const Eigen::Matrix3Xd& gradient, Eigen::Index point);
template <>
Eigen::Matrix<double, 3, 4> find_node_gradients<4>(const Eigen::Matrix3Xd& gradient, Eigen::Index point);
template <>
Eigen::Matrix<double, 3, 10> find_node_gradients<10>(const Eigen::Matrix3Xd& gradient, Eigen::Index point);

/// Σ uᵢ ⊗ ∇Nᵢ at a point, of displacements, places or speeds u (3×n) of the nodes.
template <int N>
Mat3 find_gradient(const Elements& elements, const Eigen::Matrix3Xd& gradient, const Points& u, int point) {
  const Eigen::Matrix<double, 3, N> of_nodes = find_node_gradients<N>(gradient, point);
  Mat3 H = Mat3::Zero();
  for (int i = 0; i < N; ++i)
    H.noalias() += u.col(elements.nodes(i, elements.tet_of_point(point))) * of_nodes.col(i).transpose();
  return H;
}

/// body(begin, end) for the points of tets begin … end−1 of a run, kLanes at a time.
template <class Body>
void each_points(const Elements& elements, std::ptrdiff_t begin, std::ptrdiff_t end, Body body) {
  const std::ptrdiff_t last = elements.points_per_tet * end;
  for (std::ptrdiff_t p = elements.points_per_tet * begin; p < last; p += kLanes)
    body(p, std::min<std::ptrdiff_t>(p + kLanes, last));
}

/// p1, p1_nodal: one point, mass in quarters. p2: four points, which is exact for straight-sided tets, and
/// with bent edges but for the square of how far they bend in different directions; mass lumped in proportion
/// to the consistent diagonal of straight ones [Hinton1976], so that no node has a negative one. Tets must
/// have positive volume (asserted).
Elements make_elements(const mesh::TetMesh& mesh, const mesh::Topology& topology, ElementKind kind);

/// Nodes that share a tet with each node, itself included, increasing.
std::vector<std::vector<int>> find_node_neighbours(const Elements& elements);

}  // namespace argil::solid
