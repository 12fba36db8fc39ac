#pragma once

#include <memory>

#include "linear/block_matrix.h"

namespace argil::linear {

/// CHOLMOD's simplicial LDLᵀ of a symmetric positive definite block matrix. The ordering is found once for a
/// pattern; bits depend on the matrix alone (no BLAS is called).
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const BlockMatrix& pattern);
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// Factorises the values of `matrix`, which has the pattern's structure. False when it is not positive
  /// definite.
  [[nodiscard]] bool factorise(const BlockMatrix& matrix);

  /// x = A⁻¹ b with the last factor. No allocation after the first call.
  void solve(const Points& b, Points& x);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace argil::linear
