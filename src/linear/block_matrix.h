#pragma once

#include <cstdint>
#include <vector>

#include "base/ordered_runs.h"
#include "base/types.h"

namespace argil::linear {

/// Sparse symmetric matrix of 3×3 blocks in compressed rows, both triangles stored. A vector that goes with
/// it has one 3-vector a column.
struct BlockMatrix {
  std::vector<int> row_begin;           ///< rows + 1
  std::vector<int> column;              ///< block column of each stored block, increasing within a row
  std::vector<int> diagonal;            ///< place of each row's diagonal block
  std::vector<std::uint32_t> revision;  ///< of each row's values: who changes them counts it up
  Eigen::Matrix3Xd values;  ///< 3×3 blocks side by side, block b = columns 3b … 3b+2; one column more, so
                            ///< that columns may be read four numbers at a time

  int num_rows() const { return static_cast<int>(row_begin.size()) - 1; }
  int num_blocks() const { return static_cast<int>(column.size()); }
  auto block(int b) { return values.middleCols<3>(3 * static_cast<Eigen::Index>(b)); }
  auto block(int b) const { return values.middleCols<3>(3 * static_cast<Eigen::Index>(b)); }
};

/// Pattern with the given neighbour lists (each sorted, without repeats, holding its own row); values zero.
BlockMatrix make_block_matrix(const std::vector<std::vector<int>>& neighbours);

/// Place of block (row, column), or −1 when it is not stored. O(log row length).
int find_block(const BlockMatrix& matrix, int row, int column);

/// Inverse of a 3×3 block.
Mat3 invert_block(const Mat3& block);

/// y = A x; returns x·y.
double multiply(const BlockMatrix& matrix, const Points& x, Points& y, const OrderedRuns& rows);

}  // namespace argil::linear
