#pragma once

#include <vector>

#include "linear/block_matrix.h"
#include "linear/cholesky.h"
#include "linear/pcg.h"

namespace argil::bench {

// Preconditioners in double, on one thread, for linear::ConjugateGradients. Each is made for one matrix.

/// A factor of the scalar matrix of a third of each block's trace; solves three times.
class ScalarFactor final : public linear::Preconditioner {
 public:
  explicit ScalarFactor(const linear::BlockMatrix& matrix);
  double apply(const Points& r, Points& z) override;

 private:
  linear::SparseCholesky m_factor;
  std::vector<double> m_in, m_out;
};

/// `steps` of Chebyshev's iteration over block Jacobi, with steps − 1 products [Saad2003, 12.1]. The
/// eigenvalues that it flattens end at the largest and begin at a share of that.
class Chebyshev final : public linear::Preconditioner {
 public:
  Chebyshev(const linear::BlockMatrix& matrix, int steps);
  double apply(const Points& r, Points& z) override;

 private:
  linear::MatrixOperator m_product;
  linear::BlockJacobi m_jacobi;
  int m_steps;
  double m_largest = 0.0;
  Points m_r, m_d, m_w;
};

/// (1 + L) D (1 + L)ᵀ with blocks of L where the matrix has them.
class BlockFactor final : public linear::Preconditioner {
 public:
  enum class Kind {
    ssor,        ///< D the diagonal blocks, L D the matrix's blocks: symmetric Gauss–Seidel
    incomplete,  ///< equal to the matrix wherever that has blocks: incomplete Cholesky without fill
  };
  BlockFactor(const linear::BlockMatrix& matrix, Kind kind);
  double apply(const Points& r, Points& z) override;

 private:
  std::vector<int> m_begin = {0};  // of each row's blocks of L
  std::vector<int> m_column;
  std::vector<Mat3> m_lower;
  std::vector<Mat3> m_inverse;  // of D
};

/// Block Jacobi plus an exact solve for the six rigid motions of each run of about 16 rows.
class TwoLevel final : public linear::Preconditioner {
 public:
  /// `rest`: where the rows' nodes are [m].
  TwoLevel(const linear::BlockMatrix& matrix, const Points& rest);
  double apply(const Points& r, Points& z) override;

 private:
  using Mat36 = Eigen::Matrix<double, 3, 6>;
  struct Coarse;  // matrix of the rigid motions, its lower triangle in compressed columns
  TwoLevel(const linear::BlockMatrix& matrix, const Coarse& coarse);

  linear::BlockJacobi m_jacobi;
  std::vector<int> m_run;       // of each row
  std::vector<Mat36> m_motion;  // of each row, by its run's six
  linear::SparseCholesky m_factor;
  std::vector<double> m_in, m_out;
};

}  // namespace argil::bench
