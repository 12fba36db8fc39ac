#pragma once

#include <memory>
#include <span>
#include <vector>

#include "linear/block_matrix.h"

namespace argil::linear {

enum class FactorKind {
  simplicial,  ///< LDLᵀ without BLAS: bits depend on the matrix alone
  supernodal,  ///< LLᵀ by BLAS: faster on large matrices, bits depend on the BLAS that is installed
};

/// CHOLMOD's factor of a symmetric positive definite matrix of numbers. The ordering is found once for a
/// pattern. Throws bad_alloc when there is too little memory for a factor.
class SparseCholesky {
 public:
  /// Pattern of the lower triangle in compressed columns: `column_begin` (n + 1), `row` increasing within a
  /// column and beginning with the diagonal.
  SparseCholesky(const std::vector<int>& column_begin, const std::vector<int>& row,
                 FactorKind kind = FactorKind::simplicial);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// The stored numbers in the pattern's order, to be written before factorise().
  std::span<double> values();

  /// False when the matrix is not positive definite.
  [[nodiscard]] bool factorise();

  /// x = A⁻¹ b with the last factor. No allocation after the first call.
  void solve(std::span<const double> b, std::span<double> x);

  double num_entries() const;  ///< numbers stored in the factor: what one triangular solve reads

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// The same for a symmetric positive definite block matrix.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const BlockMatrix& pattern, FactorKind kind = FactorKind::simplicial);

  /// Factorises the values of `matrix`, which has the pattern's structure. False when it is not positive
  /// definite.
  [[nodiscard]] bool factorise(const BlockMatrix& matrix);

  void solve(const Points& b, Points& x);
  double num_entries() const { return m_sparse.num_entries(); }

 private:
  struct Pattern;
  CholeskyFactor(const Pattern& pattern, FactorKind kind);

  SparseCholesky m_sparse;
  std::vector<int> m_source;  // for each stored number: its place in BlockMatrix::values
};

}  // namespace argil::linear
