#pragma once

#include <cstdint>
#include <vector>

#include "linear/operator.h"
#include "linear/short_rows.h"
#include "linear/sweep_order.h"

namespace argil::linear {

/// A matrix in floats as sweeps go through it, for products that read half the memory: off by 1e-7 of
/// Σ|A||x|.
class ShortBlocks {
 public:
  /// Takes the memory for matrices of this pattern; the functions below do the same.
  void prepare(const BlockMatrix& pattern);
  /// From now on sweeps go over the rows of these runs; null: all. The list must outlive the updates.
  void restrict_to(const std::vector<int>* runs);
  /// Takes the rows that have changed since the last update; the inverses hold what `whole` does not store,
  /// too.
  void update(const BlockMatrix& matrix, Operator& whole, const OrderedRuns& runs);

  ShortRows rows() const;
  const SweepOrder& order() const { return m_order; }

 private:
  void arrange(const BlockMatrix& pattern);
  void arrange_row(const BlockMatrix& pattern, int row);
  void take_row(const BlockMatrix& matrix, int row);

  const BlockMatrix* m_pattern = nullptr;
  int m_num_blocks = 0;
  const std::vector<int>* m_list = nullptr;
  SweepOrder m_order;
  bool m_is_arranged = false;
  bool m_had_unstored = false;
  std::vector<RowParts> m_parts;
  std::vector<int> m_column, m_source;    // two a pair
  std::vector<std::uint32_t> m_revision;  // of the rows whose values are taken
  std::vector<std::uint8_t> m_is_taken;   // of each row: its values are those of m_revision
  std::vector<float> m_values, m_diagonal, m_inverse;
  Eigen::Matrix3Xd m_whole_diagonal;  // with what is not stored
};

}  // namespace argil::linear
