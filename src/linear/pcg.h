#pragma once

#include "linear/block_matrix.h"
#include "linear/cholesky.h"
#include "linear/operator.h"

namespace argil::linear {

/// A stored matrix as an operator. Bits do not depend on `threads`, here and below.
class MatrixOperator final : public Operator {
 public:
  MatrixOperator(const BlockMatrix& matrix, int threads) : m_matrix(matrix), m_rows(threads) {}
  double multiply(const Points& x, Points& y) override { return linear::multiply(m_matrix, x, y, m_rows); }

 private:
  const BlockMatrix& m_matrix;
  OrderedRuns m_rows;
};

/// Approximate inverse applied in every iteration of the conjugate gradients.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// z = M⁻¹ r; returns r·z.
  virtual double apply(const Points& r, Points& z) = 0;
};

/// Inverses of the 3×3 diagonal blocks, with what is not stored; the other blocks are not looked at.
class BlockJacobi final : public Preconditioner {
 public:
  explicit BlockJacobi(int threads) : m_rows(threads) {}
  /// Takes the memory for so many rows; update does the same.
  void prepare(Eigen::Index num_rows);
  void update(const BlockMatrix& matrix, Operator& whole);
  double apply(const Points& r, Points& z) override;

 private:
  OrderedRuns m_rows;
  Eigen::Matrix3Xd m_inverse;  // a column more than the blocks have, as in BlockMatrix
};

/// A Cholesky factor of an earlier, similar matrix.
class StaleCholesky final : public Preconditioner {
 public:
  StaleCholesky(CholeskyFactor& factor, OrderedRuns& rows) : m_factor(factor), m_rows(rows) {}
  double apply(const Points& r, Points& z) override;

 private:
  CholeskyFactor& m_factor;
  OrderedRuns& m_rows;
};

/// Preconditioned conjugate gradients [Hestenes & Stiefel 1952; Chronopoulos & Gear 1989]. Starts from the x
/// given, stops at ‖r‖ ≤ tolerance·‖r₀‖ with r₀ of that x, or where ‖r‖ is what rounding leaves of b: a good
/// guess makes the solution better, not the work less, and what is small beside b is not lost. No allocation
/// after the first call of one size.
class ConjugateGradients {
 public:
  explicit ConjugateGradients(int threads) : m_rows(threads) {}
  /// Takes the memory for so many rows; solve does the same.
  void prepare(Eigen::Index num_rows);

  /// `goal`: a norm of the residual that is small enough as well.
  SolveReport solve(Operator& matrix, Preconditioner& preconditioner, const Points& b, double tolerance,
                    int max_iterations, Points& x, double goal = 0.0);

 private:
  double set_residual(const Points& b);
  double advance(double alpha, double beta, Points& x);
  double compute_squares(const Points& a);

  OrderedRuns m_rows;
  Points m_r, m_z, m_w, m_p, m_q;
};

}  // namespace argil::linear
