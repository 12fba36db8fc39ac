#include "linear/sweep_order.h"

#include <algorithm>

namespace argil::linear {

void SweepOrder::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  m_rows.reserve(num_rows);
  m_last.reserve(num_rows);
  m_is_last.resize(num_rows);
  m_is_first.resize(num_rows);
}

void SweepOrder::arrange(const BlockMatrix& pattern, const std::vector<int>* runs) {
  constexpr std::ptrdiff_t kFewest = 512;  // rows whose sweeps two threads share
  for (const int row : m_rows) m_is_last.data()[row] = m_is_first.data()[row] = 0;
  m_rows.clear();
  m_last.clear();
  const auto add = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row) m_rows.push_back(static_cast<int>(row));
  };
  OrderedRuns visited(1);
  visited.visit(runs);
  visited.each(pattern.num_rows(), add);
  const auto num_rows = static_cast<std::ptrdiff_t>(m_rows.size());
  std::ptrdiff_t half = num_rows;
  if (num_rows >= kFewest) {
    // The second group loses the rows that couple: the first is made as much shorter.
    find_last(pattern, num_rows / 2);
    half = (num_rows - static_cast<std::ptrdiff_t>(m_last.size())) / 2;
    find_last(pattern, half);
  }
  for (const int row : m_last) m_is_last.data()[row] = 1;
  const auto rest = std::remove_if(m_rows.begin() + half, m_rows.end(),
                                   [&](int row) { return m_is_last.data()[row] != 0; });
  std::copy(m_last.begin(), m_last.end(), rest);
  m_begin[0] = 0;
  m_begin[1] = static_cast<int>(half);
  m_begin[2] = static_cast<int>(rest - m_rows.begin());
  m_begin[3] = static_cast<int>(num_rows);
}

/// Rows from this place on that couple with one before it.
void SweepOrder::find_last(const BlockMatrix& pattern, std::ptrdiff_t first_of_second) {
  m_last.clear();
  for (std::size_t i = 0; i < m_rows.size(); ++i)
    m_is_first.data()[m_rows[i]] = static_cast<std::ptrdiff_t>(i) < first_of_second ? 1 : 0;
  for (auto i = static_cast<std::size_t>(first_of_second); i < m_rows.size(); ++i) {
    const int row = m_rows[i];
    const int* column = pattern.column.data();
    const bool is_coupled =
        std::any_of(column + pattern.row_begin.data()[row], column + pattern.row_begin.data()[row + 1],
                    [&](int other) { return m_is_first.data()[other] != 0; });
    if (is_coupled) m_last.push_back(row);
  }
}

}  // namespace argil::linear
