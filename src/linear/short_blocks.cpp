#include "linear/short_blocks.h"

#include <algorithm>

namespace argil::linear {
namespace {

void shorten(const Mat3& block, float* to) {
  for (int k = 0; k < 9; ++k) to[4 * (k / 3) + k % 3] = static_cast<float>(block(k));
}

}  // namespace

void ShortBlocks::prepare(const BlockMatrix& pattern) {
  const auto num_rows = static_cast<std::size_t>(pattern.num_rows());
  if (m_pattern == &pattern && m_num_blocks == pattern.num_blocks() && m_revision.size() == num_rows) return;
  m_pattern = &pattern;
  m_num_blocks = pattern.num_blocks();
  m_order.prepare(pattern);
  m_parts.resize(num_rows);
  int num_pairs = 0;
  for (std::size_t row = 0; row < num_rows; ++row) {
    m_parts[row] = {num_pairs, num_pairs, num_pairs};
    // Without the diagonal block; each part may leave half a pair.
    num_pairs += (pattern.row_begin[row + 1] - pattern.row_begin[row] + 1) / 2;
  }
  m_column.assign(2 * static_cast<std::size_t>(num_pairs), -1);
  m_source.assign(m_column.size(), -1);
  m_values.assign(ShortRows::kPair * static_cast<std::size_t>(num_pairs) + 2, 0.0F);
  m_diagonal.assign(12 * num_rows, 0.0F);
  m_inverse.assign(12 * num_rows, 0.0F);
  m_whole_diagonal.resize(3, 3 * pattern.num_rows());
  m_revision.resize(num_rows);
  m_is_taken.assign(num_rows, 0);
  m_is_arranged = false;
  for (int row = 0; row < pattern.num_rows(); ++row) arrange_row(pattern, row);
}

void ShortBlocks::restrict_to(const std::vector<int>* runs) {
  m_list = runs;
  m_is_arranged = false;
}

void ShortBlocks::arrange(const BlockMatrix& pattern) {
  m_order.arrange(pattern, m_list);
  for (const int moved : m_order.moved()) {
    const auto row = static_cast<std::size_t>(moved);
    for (int b = pattern.row_begin[row]; b < pattern.row_begin[row + 1]; ++b)
      arrange_row(pattern, pattern.column[static_cast<std::size_t>(b)]);
  }
  m_is_arranged = true;
}

/// A place of a pair that is left over holds a block of zeros on the diagonal.
void ShortBlocks::arrange_row(const BlockMatrix& pattern, int row) {
  const auto r = static_cast<std::size_t>(row);
  RowParts& parts = m_parts[r];
  const int first = pattern.row_begin[r];
  const int last = pattern.row_begin[r + 1];
  bool is_same = true;
  int place = 2 * parts.begin;
  const auto add = [&](int column, int source) {
    const auto at = static_cast<std::size_t>(place++);
    is_same = is_same && m_column[at] == column && m_source[at] == source;
    m_column[at] = column;
    m_source[at] = source;
  };
  const auto end_part = [&](int& end) {
    if (place % 2 != 0) add(row, -1);
    is_same = is_same && end == place / 2;
    end = place / 2;
  };
  for (int b = first; b < last; ++b) {
    const int column = pattern.column[static_cast<std::size_t>(b)];
    if (column != row && m_order.is_before(column, row)) add(column, b);
  }
  end_part(parts.middle);
  for (int b = last - 1; b >= first; --b) {
    const int column = pattern.column[static_cast<std::size_t>(b)];
    if (column != row && !m_order.is_before(column, row)) add(column, b);
  }
  end_part(parts.end);
  if (!is_same) m_is_taken[r] = 0;
}

void ShortBlocks::update(const BlockMatrix& matrix, Operator& whole, const OrderedRuns& runs) {
  prepare(matrix);
  if (!m_is_arranged) arrange(matrix);
  const bool has_unstored = whole.has_unstored();
  if (has_unstored != m_had_unstored) std::fill(m_is_taken.begin(), m_is_taken.end(), std::uint8_t{0});
  m_had_unstored = has_unstored;
  runs.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto row = static_cast<std::size_t>(begin); row < static_cast<std::size_t>(end); ++row) {
      if (has_unstored)
        m_whole_diagonal.middleCols<3>(3 * static_cast<Eigen::Index>(row)) =
            matrix.block(matrix.diagonal[row]);
      if (m_is_taken[row] != 0 && m_revision[row] == matrix.revision[row]) continue;
      m_revision[row] = matrix.revision[row];
      m_is_taken[row] = 1;
      take_row(matrix, static_cast<int>(row));
    }
  });
  if (!has_unstored) return;
  whole.add_unstored_diagonal(m_whole_diagonal);
  runs.each(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      shorten(invert_block(m_whole_diagonal.middleCols<3>(3 * row)), m_inverse.data() + 12 * row);
  });
}

void ShortBlocks::take_row(const BlockMatrix& matrix, int row) {
  const auto r = static_cast<std::size_t>(row);
  const Mat3 diagonal = matrix.block(matrix.diagonal[r]);
  float* inverse = m_inverse.data() + 12 * r;
  shorten(diagonal, m_diagonal.data() + 12 * r);
  shorten(invert_block(diagonal), inverse);
  take_pairs(matrix.values.data(), m_source.data(), m_parts[r].begin, m_parts[r].end, inverse,
             m_values.data());
}

ShortRows ShortBlocks::rows() const {
  return {m_parts.data(), m_column.data(), m_values.data(), m_diagonal.data(), m_inverse.data()};
}

}  // namespace argil::linear
