#pragma once

#include "base/ordered_loops.h"
#include "linear/block_matrix.h"
#include "solid/elements.h"

namespace argil::solid {

/// The remedy of p1_nodal against volumetric locking: relative volume changes θ of the tets averaged at the
/// nodes with the weights V κ/4 of the excess bulk moduli κ, and the energy ½ Σ D_a θ_a² with D_a = Σ V κ/4
/// [after Bonet & Burton 1998]. A tet keeps the bulk modulus of ν = 0.3 to itself, so that no checkerboard of
/// volume changes is free; where ν ≤ 0.3 throughout, the tets are plain P1.
class NodalVolume {
 public:
  /// `row_of_node`: −1 where a node has no row in the matrix.
  NodalVolume(const Elements& elements, const std::vector<int>& row_of_node, int threads);

  /// Bulk modulus over shear modulus that a tet keeps: that of ν = 0.3.
  static constexpr double kOwnBulkOverShear = 2.0 * 1.3 / (3.0 * 0.4);

  /// κ [Pa] and V [m³] of a tet.
  void set_excess(int tet, double excess_bulk, double volume);
  void update_stiffness();  ///< D_a, when any κ changed

  /// θ of every tet → its mean over the tet's nodes after averaging; κ·mean is the pressure on the tet.
  void average(const Field& volume_change, Field& mean);

  /// ½ Σ D_a θ_a² [J].
  double compute_energy(const Field& volume_change) const;

  const Field& stiffness() const { return m_stiffness; }          ///< D_a [J]
  const std::vector<int>& ring_begin() const { return m_begin; }  ///< n+1: where each node's ring begins
  const std::vector<int>& ring() const { return m_neighbour; }    ///< nodes around each node, itself too
  int find_place(int node, int neighbour) const;                  ///< of a neighbour in the ring of a node
  /// Takes ∂θ/∂x of the tets' corners [1/m], four columns a tet.
  void collect_gradients(const Eigen::Matrix3Xd& gradient);
  /// D_a ∂θ_a/∂x [J/m] of a place in a ring, from the gradients that were collected; a fourth number is 0.
  const double* ring_gradient(int place) const { return m_ring_gradient.col(place).data(); }
  std::vector<std::vector<int>> find_row_neighbours() const;
  /// Looks up the places of its blocks once the matrix's pattern is known.
  void connect(const linear::BlockMatrix& matrix);
  /// Adds scale · Σ D_a ∂θ_a ⊗ ∂θ_a of the gradients that were collected.
  void add_stiffness(double scale, linear::BlockMatrix& matrix) const;
  /// Diagonal blocks of the same, for a matrix that holds no others.
  void add_diagonal(double scale, linear::BlockMatrix& matrix) const;

 private:
  double theta(int node, const Field& volume_change) const;
  int num_nodes() const { return static_cast<int>(m_node_begin.size()) - 1; }

  OrderedRuns m_runs;
  Eigen::MatrixXi m_nodes;  // 4×m
  std::vector<int> m_node_begin, m_node_corners;
  std::vector<int> m_row_of_node;
  std::vector<int> m_begin, m_neighbour;    // nodes around each node, itself included
  std::vector<int> m_place;                 // of corner j of tet t in the ring of corner a: 16 a tet
  Field m_weight;                           // V κ/4 of each tet
  Field m_stiffness;                        // D_a
  bool m_is_stale = true;                   // D_a is of other κ
  Field m_theta;                            // of each node, while they are averaged
  Eigen::Matrix4Xd m_ring_gradient;         // D_a ∂θ_a/∂x of each ring entry, and a zero
  std::vector<int> m_block_begin, m_block;  // for each ring entry (i of a's ring, a): blocks (i, ring of a)
};

}  // namespace argil::solid
