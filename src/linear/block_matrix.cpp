#include "linear/block_matrix.h"

#include <algorithm>

#include "base/check.h"
#include "base/lanes.h"

namespace argil::linear {

BlockMatrix make_block_matrix(const std::vector<std::vector<int>>& neighbours) {
  BlockMatrix matrix;
  matrix.row_begin.push_back(0);
  for (std::size_t row = 0; row < neighbours.size(); ++row) {
    const auto& list = neighbours[row];
    const auto self = std::lower_bound(list.begin(), list.end(), static_cast<int>(row));
    ARGIL_ASSERT(self != list.end() && *self == static_cast<int>(row), row);
    matrix.diagonal.push_back(matrix.row_begin.back() + static_cast<int>(self - list.begin()));
    matrix.column.insert(matrix.column.end(), list.begin(), list.end());
    matrix.row_begin.push_back(static_cast<int>(matrix.column.size()));
  }
  matrix.revision.resize(neighbours.size(), 0);
  matrix.values.setZero(3, 3 * static_cast<Eigen::Index>(matrix.column.size()) + 1);
  return matrix;
}

Mat3 invert_block(const Mat3& block) {
  const Mat3 cofactor_transposed =
      (Mat3() << block.col(1).cross(block.col(2)).transpose(), block.col(2).cross(block.col(0)).transpose(),
       block.col(0).cross(block.col(1)).transpose())
          .finished();
  return cofactor_transposed / block.col(0).dot(block.col(1).cross(block.col(2)));
}

int find_block(const BlockMatrix& matrix, int row, int column) {
  const auto begin = matrix.column.begin() + matrix.row_begin[static_cast<std::size_t>(row)];
  const auto end = matrix.column.begin() + matrix.row_begin[static_cast<std::size_t>(row) + 1];
  const auto found = std::lower_bound(begin, end, column);
  return found != end && *found == column ? static_cast<int>(found - matrix.column.begin()) : -1;
}

namespace {

/// Rows begin … end−1 of y = A x; returns their share of x·y. Blocks of even and odd places apart: no sum
/// waits for the one before it.
ARGIL_EVERY_PROCESSOR double multiply_rows(const BlockMatrix& matrix, const double* x, std::ptrdiff_t begin,
                                           std::ptrdiff_t end, double* y) {
  const int* column = matrix.column.data();
  Quad dot = {};
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    int b = matrix.row_begin.data()[row];
    const int last = matrix.row_begin.data()[row + 1];
    const double* a = matrix.values.data() + 9 * static_cast<std::ptrdiff_t>(b);
    Quad even[3] = {}, odd[3] = {};
    const auto add = [&](Quad * sum) __attribute__((always_inline)) {
      const double* p = x + 3 * static_cast<std::ptrdiff_t>(column[b]);
      Quad block_column;
      for (int k = 0; k < 3; ++k) {
        read(a + 3 * k, block_column);
        sum[k] += block_column * p[k];
      }
      a += 9;
      ++b;
    };
    while (b + 1 < last) {
      add(even);
      add(odd);
    }
    if (b < last) add(even);
    const Quad sum = (even[0] + odd[0]) + (even[1] + odd[1]) + (even[2] + odd[2]);
    for (int k = 0; k < 3; ++k) y[3 * row + k] = sum[k];
    dot += sum * Quad{x[3 * row], x[3 * row + 1], x[3 * row + 2], 0.0};
  }
  return dot[0] + dot[1] + dot[2];
}

}  // namespace

double multiply(const BlockMatrix& matrix, const Points& x, Points& y, const OrderedRuns& rows) {
  return rows.sum(matrix.num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return multiply_rows(matrix, x.data(), begin, end, y.data());
  });
}

}  // namespace argil::linear
