#pragma once

#include <memory>
#include <vector>

#include "linear/block_matrix.h"
#include "solid/materials.h"
#include "solid/nodal_product.h"

namespace argil::solid {

/// How often M, the stiffness with kept rotations and the tangent ∂P/∂F enter the matrix.
struct MatrixShares {
  double mass = 0.0;
  double kept = 0.0;
  double exact = 0.0;
  bool operator==(const MatrixShares&) const = default;
};

/// A δ = r of the present iterate. Rows of the matrix that stay the same from one step to the next are kept;
/// they can be made anew at any time.
struct System {
  System(const Model& model, const Materials& materials);

  linear::BlockMatrix matrix;
  std::vector<int> block_of_corner_pair;  ///< N² a tet: place of block (i, j), −1 where there is none
  MatrixShares stored_shares;             ///< of the matrix that is stored
  std::vector<char> is_tet_changed;       ///< its stiffness or frame, since then
  std::vector<char> unloads;              ///< 1 a point: is elastic although at its yield (unloading.h)
  int unloading_rounds = 0;               ///< of the step
  std::vector<char> is_row_stale;         ///< holds something that the next matrix may not
  Eigen::Matrix<double, 81, Eigen::Dynamic> tangent;  ///< ∂P/∂F of each point, where it is wanted [Pa]
  Eigen::Matrix<double, 9, Eigen::Dynamic>
      pairs;  ///< of a tet's nodes (find_pair), where they are kept [N/m]
  Eigen::Matrix<double, 9, Eigen::Dynamic> point_pairs;  ///< p2: kPairBlocks a point, of its corners [N/m]
  bool is_projected = true;                              ///< with its negative modes set to zero
  std::unique_ptr<NodalProduct> nodal_product;  ///< p1_nodal's nodal stiffness where the matrix lacks it
  Points rhs, delta;                            ///< a column a row: r [N s] and δ [m/s]
  Points v_base;                                ///< 3×n velocities that δ is added to [m/s]

  bool has_nodal_blocks(const Materials& materials) const { return materials.nodal() && !nodal_product; }
  /// The next matrix keeps no row of this one.
  void mark_all_changed();
};

/// p1_nodal: from now on the matrix holds the nodes' stiffness after all: where a factor is needed, or more
/// exactness than floats have.
void store_nodal_stiffness(const Model& model, const Materials& materials, System& system);
/// And without it again, as a system is made.
void drop_nodal_stiffness(const Model& model, const Materials& materials, System& system);

}  // namespace argil::solid
