#pragma once

#include <vector>

#include "linear/block_matrix.h"
#include "preconditioners/ssor_order.h"

namespace argil::bench {

struct SsorArrays;

/// Conjugate gradients in floats over symmetric block Gauss–Seidel within groups of rows, by Eisenstat's
/// trick [Eisenstat1981]. With the rows scaled so that the diagonal blocks are 1,
///   A = L + 1 + Lᵀ + R,   L below the diagonal within groups and of the last one, R what couples groups,
///   Â = (1+L)⁻¹ A (1+L)⁻ᵀ:   t = (1+L)⁻ᵀ p,   Â p = t + (1+L)⁻¹ (p − t + R t),
/// an iteration reads each block once. Groups go on different threads; bits do not depend on these.
class ShortSsor {
 public:
  ShortSsor(const linear::BlockMatrix& matrix, SsorOrder order, int threads);

  void update(const linear::BlockMatrix& matrix);

  struct Report {
    int iterations = 0;
    int checks = 0;  ///< of the residual: half a product each
    double residual = 0.0;
    bool converged = false;
  };
  /// x of A x = b from 0 until ‖b − A x‖ ≤ tolerance·‖b‖. What iterations know is ‖(1+L)⁻¹(b − A x)‖;
  /// whenever this is so small that the residual should be, by what the two were at last, the residual is
  /// taken.
  Report solve(const Points& b, double tolerance, int max_iterations, Points& x);

 private:
  /// Blocks of some kind, row by row; rows and columns by their places in the order.
  struct Blocks {
    std::vector<int> begin = {0};
    std::vector<int> column;
    std::vector<int> source;    // where they are in the matrix
    std::vector<float> values;  // 9 each, and one more
    void add(int to_column, int from) {
      column.push_back(to_column);
      source.push_back(from);
    }
  };
  SsorArrays arrays();
  template <class Body>
  double sum_groups(Body body);
  template <class Body>
  double sum_groups(std::size_t first, std::size_t last, Body body);
  template <class Body>
  double go_forth(Body body);
  template <class Body>
  void go_back(Body body);
  void set_start(const Points& b, double first);
  void write_solution(double first, Points& x);

  SsorOrder m_order;
  int m_threads;
  Blocks m_upper;                         // −Lᵀ, columns falling: what was found last comes last
  Blocks m_other;                         // R
  Blocks m_lower;                         // −L
  std::vector<float> m_scale, m_unscale;  // C⁻¹ and C of each diagonal block C Cᵀ, 3 columns of four a row
  std::vector<float> m_r, m_p, m_t, m_s, m_x;  // four a row
  std::vector<double> m_sums;                  // of each group
};

}  // namespace argil::bench
