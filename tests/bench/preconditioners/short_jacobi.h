#pragma once

#include <vector>

#include "base/ordered_loops.h"
#include "linear/short_blocks.h"

namespace argil::bench {

/// The iteration of linear/short_iteration.h from x = 0, without what it keeps of earlier solves.
class ShortJacobi {
 public:
  explicit ShortJacobi(int threads) : m_runs(threads) {}
  void update(const linear::BlockMatrix& matrix);
  struct Report {
    int iterations = 0;
    bool converged = false;
  };
  Report solve(const Points& b, double tolerance, int max_iterations, Points& x);

 private:
  OrderedRuns m_runs;
  linear::ShortBlocks m_blocks;
  std::vector<float> m_r, m_z, m_w, m_p, m_q, m_x;  // four a row
  std::vector<linear::ShortSums> m_sums;            // of each run
};

}  // namespace argil::bench
