#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/archive.h"
#include "linear/block_matrix.h"
#include "linear/operator.h"

namespace argil::linear {

enum class SolverKind {
  pcg,           ///< pcg_jacobi while it takes few iterations, pcg_cholesky from the first long solve on
  pcg_cholesky,  ///< conjugate gradients preconditioned by a kept simplicial factor
  pcg_jacobi,  ///< conjugate gradients preconditioned by the 3×3 diagonal blocks, from kRoomForFloats up by
               ///< block Gauss–Seidel
  pcg_matrix_free,  ///< the same; the matrix holds its diagonal blocks only and the operator multiplies
  cholesky,         ///< simplicial LDLᵀ, renewed whenever the matrix changed: the bit-exact reference
  supernodal,       ///< supernodal LLᵀ by BLAS, renewed likewise
};

/// By a factor of the very matrix: no iterations.
constexpr bool is_direct(SolverKind kind) {
  return kind == SolverKind::cholesky || kind == SolverKind::supernodal;
}

/// From this tolerance on, the rounding of floats, 6e-8 of a matrix, is beside it.
inline constexpr double kRoomForFloats = 1e-4;

struct SolverParams {
  SolverKind kind = SolverKind::pcg;
  double tolerance = 1e-3;       ///< residual over that of the first guess at which an iteration stops
  int max_iterations = 500;      ///< of one solve
  int jacobi_iterations = 150;   ///< pcg: a solve that needs more brings in the factor
  int refactor_iterations = 12;  ///< pcg_cholesky: factorise anew after a solve with more iterations
};

/// What the solves of a run have cost so far.
struct SolverCost {
  std::int64_t solves = 0;
  std::int64_t iterations = 0;
  int factorisations = 0;
  double multiplications = 0.0;  ///< about; of products and triangular solves, factorisations left out
};

/// One way to solve A x = b. The matrix's pattern is the same in every call.
class Solver {
 public:
  virtual ~Solver() = default;

  /// `product` multiplies by A; `matrix` stores it (pcg_matrix_free: its diagonal blocks alone), but for what
  /// `product` adds to it, which only the kinds without a factor's exactness take (pcg, pcg_jacobi). x holds
  /// the first guess. Not converged with an infinite residual: the matrix is not positive definite.
  virtual SolveReport solve(const BlockMatrix& matrix, Operator& product, const Points& b, Points& x) = 0;

  /// Takes the memory that solves with matrices of this pattern want.
  virtual void prepare(const BlockMatrix& /*pattern*/) {}

  /// From now on the system of these runs of rows alone (base/ordered_loops.h; the list must outlive the
  /// solves), as if there were no others: x stays as it is outside. Null: all. False when this kind solves
  /// whole systems only.
  virtual bool restrict_to(const std::vector<int>* /*runs*/) { return false; }

  /// From now on an iteration may also stop where the norm of its residual is at most `goal` [of b], however
  /// little that is beside the first guess's. 0: never for that.
  void set_goal(double goal) { m_goal = goal; }

  const SolverCost& cost() const { return m_cost; }

  /// What the next solve takes from the last ones, under names that begin with `prefix`. `pattern`: any
  /// matrix with the pattern of those to come.
  virtual void serialize(Archive& archive, const std::string& prefix, const BlockMatrix& pattern);

  /// Solves since the last commit count from now on; or they never were, and the next one begins with what
  /// the first of them began with.
  virtual void commit() { m_committed_cost = m_cost; }
  virtual void roll_back(const BlockMatrix& /*pattern*/) { m_cost = m_committed_cost; }

 protected:
  SolverCost m_cost;
  double m_goal = 0.0;

 private:
  SolverCost m_committed_cost;
};

/// Bits do not depend on `threads`.
std::unique_ptr<Solver> make_solver(const SolverParams& params, int threads = 1);

}  // namespace argil::linear
