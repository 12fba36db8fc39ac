#pragma once

#include <vector>

#include "linear/block_matrix.h"

namespace argil::bench {

struct SsorArrays;

/// Conjugate gradients in floats over symmetric block Gauss–Seidel within groups of consecutive rows, by
/// Eisenstat's trick [Eisenstat1981]. With the rows scaled so that the diagonal blocks are 1,
///   A = L + 1 + Lᵀ + R,   L within the groups below the diagonal, R what couples groups,
///   Â = (1+L)⁻¹ A (1+L)⁻ᵀ:   t = (1+L)⁻ᵀ p,   Â p = t + (1+L)⁻¹ (p − t + R t),
/// an iteration reads each block once. Groups go on different threads; bits do not depend on these.
class ShortSsor {
 public:
  /// Groups begin at `group_begin`, which ends with the number of rows.
  ShortSsor(const linear::BlockMatrix& matrix, std::vector<int> group_begin, int threads);

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
  /// Blocks of some kind, row by row.
  struct Blocks {
    std::vector<int> begin = {0};
    std::vector<int> column;
    std::vector<int> source;    // place in the matrix
    std::vector<float> values;  // 9 each, and one more
    void add_row(const std::vector<int>& places, const linear::BlockMatrix& matrix);
  };
  SsorArrays arrays();
  template <class Body>
  double sum_groups(Body body);

  std::vector<int> m_group_begin;
  int m_threads;
  Blocks m_upper;                              // −Lᵀ, columns falling: what was found last comes last
  Blocks m_other;                              // R
  Blocks m_lower;                              // −L
  Eigen::Matrix3Xd m_scale;                    // C⁻¹ of each diagonal block C Cᵀ
  std::vector<float> m_unscale;                // C, 3 columns of four a row
  std::vector<float> m_r, m_p, m_t, m_s, m_x;  // four a row
  std::vector<double> m_sums;                  // of each group
};

}  // namespace argil::bench
