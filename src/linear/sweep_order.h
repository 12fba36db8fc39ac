#pragma once

#include <cstdint>
#include <vector>

#include "linear/block_matrix.h"

namespace argil::linear {

/// The order in which sweeps go over rows: two groups that do not couple with one another, each for a thread
/// of its own, then the rows of the second half that couple with the first. Few rows are one group.
class SweepOrder {
 public:
  /// Takes the memory for matrices of this pattern.
  void prepare(const BlockMatrix& pattern);
  /// Of the rows of these runs (base/ordered_loops.h) alone; null: of all. moved() then has the rows that
  /// come first or last where they did not before; in the order of numbers, which prepare leaves, none is
  /// last.
  void arrange(const BlockMatrix& pattern, const std::vector<int>* runs);
  const std::vector<int>& moved() const { return m_moved; }

  /// Places of rows(): the group's first and the one after its last. kLast: the rows that couple the others.
  static constexpr int kGroups = 2;
  static constexpr int kLast = kGroups;
  int begin(int group) const { return m_begin[group]; }
  int end(int group) const { return m_begin[group + 1]; }
  const std::vector<int>& rows() const { return m_rows; }

  /// Is `row` gone over before `other`?
  bool is_before(int row, int other) const {
    const bool is_last = m_is_last.data()[row] != 0;
    return is_last == (m_is_last.data()[other] != 0) ? row < other : !is_last;
  }

 private:
  void find_last(const BlockMatrix& pattern, std::ptrdiff_t half);

  std::vector<int> m_rows;  // by place
  int m_begin[kGroups + 2] = {};
  std::vector<int> m_last, m_moved;
  std::vector<std::uint8_t> m_is_last, m_is_listed;  // of each row
};

}  // namespace argil::linear
