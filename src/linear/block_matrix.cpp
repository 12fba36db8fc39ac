#include "linear/block_matrix.h"

#include <algorithm>

#include "base/check.h"
#include "base/parallel.h"

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
  matrix.values.setZero(3, 3 * static_cast<Eigen::Index>(matrix.column.size()));
  return matrix;
}

int find_block(const BlockMatrix& matrix, int row, int column) {
  const auto begin = matrix.column.begin() + matrix.row_begin[static_cast<std::size_t>(row)];
  const auto end = matrix.column.begin() + matrix.row_begin[static_cast<std::size_t>(row) + 1];
  const auto found = std::lower_bound(begin, end, column);
  return found != end && *found == column ? static_cast<int>(found - matrix.column.begin()) : -1;
}

void multiply(const BlockMatrix& matrix, const Points& x, Points& y, int threads) {
  const double* values = matrix.values.data();
  const double* in = x.data();
  double* out = y.data();
  parallel_for(matrix.num_rows(), threads, [&](std::ptrdiff_t row) {
    const auto r = static_cast<std::size_t>(row);
    double y0 = 0.0;
    double y1 = 0.0;
    double y2 = 0.0;
    for (int b = matrix.row_begin[r]; b < matrix.row_begin[r + 1]; ++b) {
      const double* a = values + 9 * static_cast<std::ptrdiff_t>(b);
      const double* p = in + 3 * static_cast<std::ptrdiff_t>(matrix.column[static_cast<std::size_t>(b)]);
      y0 += a[0] * p[0] + a[3] * p[1] + a[6] * p[2];
      y1 += a[1] * p[0] + a[4] * p[1] + a[7] * p[2];
      y2 += a[2] * p[0] + a[5] * p[1] + a[8] * p[2];
    }
    out[3 * row] = y0;
    out[3 * row + 1] = y1;
    out[3 * row + 2] = y2;
  });
}

}  // namespace argil::linear
