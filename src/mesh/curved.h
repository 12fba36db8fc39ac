#pragma once

#include <vector>

#include "mesh/bisection.h"
#include "mesh/quadratic.h"
#include "mesh/topology.h"

namespace argil::mesh {

// Ten-node tets whose edges bend with the body's surface.

/// What became of the edges of a boundary.
struct CurvedEdges {
  int num_curved = 0;
  int num_straight = 0;  ///< that would bend, but tets at them do not bear it
};

/// Sets `edge_nodes`: of each edge of the boundary the place that `boundary_point` gives. Where a Jacobian of
/// a tet at its corners, its edges' nodes or its points of integration would fall below a share of that of
/// straight edges, all its edges stay straight.
CurvedEdges curve_boundary(const BoundaryPoint& boundary_point, const Topology& topology, TetMesh& mesh);

/// Nodes of the tets that have bent edges, found by tet.
class CurvedTets {
 public:
  explicit CurvedTets(const TetMesh& mesh);
  /// None: its edges are straight.
  const QuadraticNodes* find(int tet) const {
    if (m_place.empty()) return nullptr;
    const int place = m_place[static_cast<std::size_t>(tet)];
    return place < 0 ? nullptr : &m_nodes[static_cast<std::size_t>(place)];
  }

 private:
  std::vector<int> m_place;  // of each tet in m_nodes; −1: straight
  std::vector<QuadraticNodes> m_nodes;
};

/// ∫Nᵢ dV [m³] of each node, by a rule that is exact for them; Σ is the tet's volume.
Eigen::Matrix<double, 10, 1> integrate_shape(const QuadraticNodes& nodes);

/// Barycentric coordinates of x in a bent tet, found from those in the straight one; these, where x lies too
/// far outside for there to be any near them.
Vec4 find_in_tet(const QuadraticNodes& nodes, const Vec3& x, const Vec4& straight);

/// Volume [m³] of every tet at rest, bent as it is.
Field compute_rest_volumes(const TetMesh& mesh);

}  // namespace argil::mesh
