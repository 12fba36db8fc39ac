#pragma once

#include <vector>

#include "base/ordered_loops.h"
#include "solid/nodal_volume.h"
#include "solid/supports.h"

namespace argil::solid {

/// The nodes' part of p1_nodal's stiffness by its factors, s Σ g_a g_aᵀ / D_a with g_a = D_a ∂θ_a/∂x: two
/// passes over the nodes around each node take a third of what its blocks take, which join nodes two edges
/// apart. Bits do not depend on `threads`.
class NodalProduct {
 public:
  /// `node_of_row`, `row_of_node`: of the matrix that holds the rest; held components do not count.
  /// `is_short`: factors are kept in floats, off by 6e-8: a symmetric matrix as near to the true one.
  NodalProduct(const NodalVolume& nodal, const std::vector<int>& node_of_row,
               const std::vector<int>& row_of_node, const Constraints& constraints, bool is_short,
               int threads);

  /// Takes the gradients that `nodal` has collected, `scale` times the matrix.
  void update(double scale);

  /// y += s Σ g_a (g_a·x) / D_a; returns x · what was added. A column a row of the matrix.
  double add(const Points& x, Points& y);
  /// The same with factors in floats; four numbers a row.
  double add(const float* x, float* y);
  /// The same matrix's 3×3 diagonal blocks, side by side.
  void add_diagonal(Eigen::Matrix3Xd& blocks) const;

 private:
  /// √(s/D_a) g_a, four numbers an entry.
  template <class Real>
  struct Factors {
    std::vector<Real> by_node;  // the entries of a node in the order of its ring
    std::vector<Real> by_row;   // the same once more, row by row
    std::vector<Real> x, y;     // 4 a row
    std::vector<Real> theta;    // of each node
  };
  template <class Real>
  void update_factors(double scale, Factors<Real>& factors);
  bool find_busy_runs();
  template <class Real>
  double add_product(const Points& x, Factors<Real>& factors, Points& y);
  template <class Real>
  double add_product(const Real* x, Factors<Real>& factors, Real* y);

  std::ptrdiff_t num_nodes() const { return static_cast<std::ptrdiff_t>(m_node_begin.size()) - 1; }
  std::ptrdiff_t num_rows() const { return static_cast<std::ptrdiff_t>(m_row_begin.size()) - 1; }

  const NodalVolume& m_nodal;
  OrderedRuns m_runs;
  OrderedRuns m_node_runs, m_row_runs;         // where some node has any such stiffness:
  std::vector<int> m_busy_nodes, m_busy_rows;  // these runs, increasing
  bool m_is_short;
  Factors<float> m_short;
  Factors<double> m_long;
  std::vector<int> m_node_begin, m_row;  // row of each entry of a node
  std::vector<int> m_place;              // and its place in the ring
  std::vector<int> m_row_begin, m_node;  // node of each entry of a row
  std::vector<int> m_source;             // and its place among those of the nodes
  std::vector<double> m_is_free;         // of each row's components: 1, held: 0; 4 a row
};

}  // namespace argil::solid
