#pragma once

#include <memory>

#include "linear/block_matrix.h"

namespace argil::linear {

enum class FactorKind {
  simplicial,  ///< LDLᵀ without BLAS: bits depend on the matrix alone
  supernodal,  ///< LLᵀ by BLAS: faster on large matrices, bits depend on the BLAS that is installed
};

/// CHOLMOD's factor of a symmetric positive definite block matrix. The ordering is found once for a pattern.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const BlockMatrix& pattern, FactorKind kind = FactorKind::simplicial);
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// Factorises the values of `matrix`, which has the pattern's structure. False when it is not positive
  /// definite.
  [[nodiscard]] bool factorise(const BlockMatrix& matrix);

  /// x = A⁻¹ b with the last factor. No allocation after the first call.
  void solve(const Points& b, Points& x);

  /// Numbers stored in the factor: what one triangular solve reads.
  double num_entries() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace argil::linear
