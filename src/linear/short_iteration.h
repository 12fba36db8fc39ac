#pragma once

#include <string>
#include <vector>

#include "base/archive.h"
#include "linear/last_changes.h"
#include "linear/short_blocks.h"

namespace argil::linear {

/// The method of ConjugateGradients over the diagonal blocks, in floats but for its sums: what is added to x
/// is found from b − A x, which is taken in double, so that floats round only what the solve changes. For
/// tolerances above kRoomForFloats. Each iteration goes over the rows twice. Begins with what the last solves
/// added to their x. Bits do not depend on `threads`.
class ShortIteration {
 public:
  explicit ShortIteration(int threads) : m_runs(threads) {}

  /// `matrix` must be what it was in every call but for its values. `goal`: a norm of the residual that is
  /// small enough as well.
  SolveReport solve(const BlockMatrix& matrix, Operator& whole, const Points& b, double tolerance,
                    int max_iterations, Points& x, double goal = 0.0);

  /// Takes the memory for matrices of this pattern; solve does the same.
  void prepare(const BlockMatrix& pattern);
  /// From now on rows of these runs alone, as if there were no others. Null: all.
  void visit(const std::vector<int>* runs);
  /// What the next solve takes from the last one.
  void exchange_state(Archive& archive, const std::string& prefix);

 private:
  void clear_left_rows();
  SolveReport iterate(Operator& whole, double first, double goal, int max_iterations);

  OrderedRuns m_runs;
  const std::vector<int>* m_visited = nullptr;
  std::vector<int> m_solved;      // runs of the last solve
  bool m_has_solved_all = false;  // or may have
  bool m_is_changed = true;
  ShortBlocks m_blocks;
  LastChanges m_last;
  Points m_product;
  std::vector<float> m_r, m_z, m_w, m_p, m_q, m_x;  // four a row
  std::vector<double> m_products;                   // z·w of each run
  std::vector<ShortBlocks::Sums> m_sums;            // of each run
};

}  // namespace argil::linear
