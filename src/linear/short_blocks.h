#pragma once

#include <vector>

#include "linear/block_matrix.h"

namespace argil::linear {

/// A matrix in floats, for a product that reads half the memory: off by 1e-7 of Σ|A||x|.
class ShortBlocks {
 public:
  void update(const BlockMatrix& matrix, const OrderedRuns& rows);
  /// y = A x; returns x·y. `pattern`: the matrix of the last update.
  double multiply(const BlockMatrix& pattern, const Points& x, Points& y, OrderedRuns& rows);

 private:
  std::vector<float> m_values;  // 9 a block
  std::vector<float> m_x;       // 4 a row
};

}  // namespace argil::linear
