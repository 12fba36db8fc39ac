#pragma once

#include <string>
#include <vector>

#include "base/archive.h"
#include "linear/last_changes.h"
#include "linear/short_blocks.h"

namespace argil::linear {

/// Conjugate gradients in floats but for sums: what is added to x is found from b − A x, which is taken in
/// double, so that floats round only what the solve changes. For tolerances above kRoomForFloats. Begins with
/// what the last solves added to their x. Bits do not depend on `threads`.
///
/// A matrix that is stored whole is preconditioned by symmetric block Gauss–Seidel; by Eisenstat's trick
/// [Eisenstat1981] that takes no product beside its sweeps. With A = D (L + 1 + U), see ShortRows, and
/// ρ = (1+L)⁻¹ D⁻¹ (b − A x), directions t = (1+U)⁻¹ p change ρ by t + (1+L)⁻¹ (p − t), and an iteration
/// reads each block once. Of one with unstored parts D and p − t would have to hold these too, large beside
/// the curvature t·A t that is left of them: there the diagonal blocks precondition.
class ShortIteration {
 public:
  explicit ShortIteration(int threads) : m_threads(threads), m_runs(threads) {}

  /// `matrix` must be what it was in every call but for its values. `goal`: a norm of the residual that is
  /// small enough as well.
  SolveReport solve(const BlockMatrix& matrix, Operator& whole, const Points& b, double tolerance,
                    int max_iterations, Points& x, double goal = 0.0);

  /// Takes the memory for matrices of this pattern; solve does the same.
  void prepare(const BlockMatrix& pattern);
  /// From now on rows of these runs alone, as if there were no others. Null: all.
  void restrict_to(const std::vector<int>* runs);
  /// What the next solve takes from the last one.
  void serialize(Archive& archive, const std::string& prefix);
  /// Solves since the last commit count from now on; or they never were.
  void commit() { m_last.commit(); }
  void roll_back();

 private:
  void clear_left_rows();
  double find_residual(Operator& whole, const Points& b, const Points& x);
  void add_to(Points& x, double scale) const;
  SolveReport iterate(Operator& whole, double first, double goal, int max_iterations, bool begins);
  SolveReport sweep(const LastChanges::Start& start, double goal, int max_iterations);
  SolveReport iterate_over_blocks(Operator& whole, const LastChanges::Start& start, double goal,
                                  int max_iterations);
  template <class Body>
  void each_group(Body body);
  Substituted substitute_groups();
  double sweep_groups(float beta);

  int m_threads;
  OrderedRuns m_runs;
  const std::vector<int>* m_list = nullptr;
  std::vector<int> m_solved;      // runs of the last solve
  bool m_has_solved_all = false;  // or may have
  bool m_is_changed = true;
  ShortBlocks m_blocks;
  LastChanges m_last;
  Points m_product;
  // Four numbers a row. Of block Jacobi z and w are in the places of t and s, q in that of ρ.
  std::vector<float> m_r, m_t, m_s, m_p, m_rho, m_x;
  std::vector<ShortSums> m_sums;  // of each run
};

}  // namespace argil::linear
