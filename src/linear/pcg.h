#pragma once

#include <memory>

#include "linear/block_matrix.h"
#include "linear/cholesky.h"

namespace argil::linear {

struct SolveReport {
  bool converged = false;
  int iterations = 0;
  double relative_residual = 0.0;  ///< ‖b − A x‖₂ / ‖b‖₂ by the recurrence
};

/// Approximate inverse applied in every iteration of the conjugate gradients.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void apply(const Points& r, Points& z) = 0;
};

/// Inverses of the 3×3 diagonal blocks.
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
  SolveReport solve(const BlockMatrix& matrix, Preconditioner& preconditioner, const Points& b,
                    double tolerance, int max_iterations, int threads, Points& x);

 private:
  Points m_r, m_z, m_p, m_q;
};

}  // namespace argil::linear
