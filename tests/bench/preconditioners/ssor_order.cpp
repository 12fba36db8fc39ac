#include "preconditioners/ssor_order.h"

#include <cstdint>

namespace argil::bench {

SsorOrder make_groups(int num_rows, int count) {
  SsorOrder order;
  for (int row = 0; row < num_rows; ++row) order.rows.push_back(row);
  for (int g = 0; g <= count; ++g)
    order.group_begin.push_back(static_cast<int>(std::int64_t{num_rows} * g / count));
  return order;
}

SsorOrder make_separated_groups(const linear::BlockMatrix& matrix, int count) {
  const std::vector<int> begin = make_groups(matrix.num_rows(), count).group_begin;
  SsorOrder order;
  order.is_last_apart = true;
  std::vector<int> last;
  for (std::size_t g = 0; g + 1 < begin.size(); ++g) {
    order.group_begin.push_back(static_cast<int>(order.rows.size()));
    for (int row = begin[g]; row < begin[g + 1]; ++row) {
      const int first = matrix.row_begin[static_cast<std::size_t>(row)];
      const bool is_coupled = matrix.column[static_cast<std::size_t>(first)] < begin[g];
      (is_coupled ? last : order.rows).push_back(row);
    }
  }
  order.group_begin.push_back(static_cast<int>(order.rows.size()));
  order.rows.insert(order.rows.end(), last.begin(), last.end());
  order.group_begin.push_back(static_cast<int>(order.rows.size()));
  return order;
}

}  // namespace argil::bench
