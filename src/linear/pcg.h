#pragma once

#include <memory>

#include "linear/block_matrix.h"
#include "linear/cholesky.h"

namespace argil::linear {

struct SolveReport {
  bool converged = false;
  int iterations = 0;              ///< 0: solved by a factor
  double relative_residual = 0.0;  ///< ‖b − A x‖₂ / ‖b‖₂; of an iteration by its recurrence; infinite: A
                                   ///< was seen not to be positive definite
};

/// A symmetric positive definite matrix by its product alone.
class Operator {
 public:
  virtual ~Operator() = default;
  /// y = A x; y has the shape of x.
  virtual void multiply(const Points& x, Points& y) = 0;
};

/// A stored matrix as an operator.
class MatrixOperator final : public Operator {
 public:
  MatrixOperator(const BlockMatrix& matrix, int threads) : m_matrix(matrix), m_threads(threads) {}
  void multiply(const Points& x, Points& y) override { linear::multiply(m_matrix, x, y, m_threads); }

 private:
  const BlockMatrix& m_matrix;
  int m_threads;
};

/// Approximate inverse applied in every iteration of the conjugate gradients.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void apply(const Points& r, Points& z) = 0;
};

/// Inverses of the 3×3 diagonal blocks; the other blocks are not looked at.
class BlockJacobi final : public Preconditioner {
 public:
  void update(const BlockMatrix& matrix);
  void apply(const Points& r, Points& z) override;

 private:
  Eigen::Matrix3Xd m_inverse;
};

/// A Cholesky factor of an earlier, similar matrix.
class StaleCholesky final : public Preconditioner {
 public:
  explicit StaleCholesky(CholeskyFactor& factor) : m_factor(factor) {}
  void apply(const Points& r, Points& z) override { m_factor.solve(r, z); }

 private:
  CholeskyFactor& m_factor;
};

/// Preconditioned conjugate gradients [Hestenes & Stiefel 1952]. Starts from the x given, stops at
/// ‖r‖ ≤ tolerance·‖b‖. Sums run in a fixed order; no allocation after the first call of one size.
class ConjugateGradients {
 public:
  SolveReport solve(Operator& matrix, Preconditioner& preconditioner, const Points& b, double tolerance,
                    int max_iterations, Points& x);

 private:
  Points m_r, m_z, m_p, m_q;
};

}  // namespace argil::linear
