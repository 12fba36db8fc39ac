#include "linear/sweep_order.h"

#include <algorithm>
#include <utility>

namespace argil::linear {

void SweepOrder::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  m_rows.clear();
  m_last.clear();
  m_rows.reserve(num_rows);
  m_last.reserve(num_rows);
  m_moved.reserve(2 * num_rows);
  m_is_last.assign(num_rows, 0);
  m_is_listed.assign(num_rows, 0);
}

void SweepOrder::arrange(const BlockMatrix& pattern, const std::vector<int>* runs) {
  constexpr std::ptrdiff_t kFewest = 512;  // rows whose sweeps two threads share
  for (const int row : m_rows) m_is_listed.data()[row] = 0;
  m_rows.clear();
  m_moved = m_last;
  m_last.clear();
  OrderedRuns listed(1);
  listed.restrict_to(runs);
  listed.each(pattern.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) {
      m_rows.push_back(static_cast<int>(row));
      m_is_listed.data()[row] = 1;
    }
  });
  const auto num_rows = static_cast<std::ptrdiff_t>(m_rows.size());
  std::ptrdiff_t half = num_rows;
  if (num_rows >= kFewest) {
    // The second group loses the rows that couple: the first is made as much shorter.
    find_last(pattern, num_rows / 2);
    half = (num_rows - static_cast<std::ptrdiff_t>(m_last.size())) / 2;
    find_last(pattern, half);
  }
  // Those that were last and are no more stay in the list, and those that have come are added.
  std::erase_if(m_moved, [&](int row) { return std::binary_search(m_last.begin(), m_last.end(), row); });
  for (const int row : m_moved) m_is_last.data()[row] = 0;
  for (const int row : m_last)
    if (std::exchange(m_is_last.data()[row], std::uint8_t{1}) == 0) m_moved.push_back(row);
  const auto rest = std::remove_if(m_rows.begin() + half, m_rows.end(),
                                   [&](int row) { return m_is_last.data()[row] != 0; });
  std::copy(m_last.begin(), m_last.end(), rest);
  m_begin[0] = 0;
  m_begin[1] = static_cast<int>(half);
  m_begin[2] = static_cast<int>(rest - m_rows.begin());
  m_begin[3] = static_cast<int>(num_rows);
}

/// Rows from place `half` on that couple with one before it.
void SweepOrder::find_last(const BlockMatrix& pattern, std::ptrdiff_t half) {
  m_last.clear();
  const int boundary = m_rows.data()[half];
  for (auto at = m_rows.begin() + half; at != m_rows.end(); ++at) {
    const int* column = pattern.column.data() + pattern.row_begin.data()[*at];
    for (; *column < boundary; ++column)
      if (m_is_listed.data()[*column] != 0) {
        m_last.push_back(*at);
        break;
      }
  }
}

}  // namespace argil::linear
