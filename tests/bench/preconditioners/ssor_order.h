#pragma once

#include <vector>

#include "linear/block_matrix.h"

namespace argil::bench {

/// In which order rows are gone through.
struct SsorOrder {
  std::vector<int> rows;
  std::vector<int> group_begin;  ///< places where groups of them begin, and how many rows there are
  bool is_last_apart = false;    ///< the last group is gone through after all others, which may couple with
                                 ///< it but with none of them among each other
};

/// Groups of consecutive rows of about equal length.
SsorOrder make_groups(int num_rows, int count);

/// The same without the rows that couple with an earlier group: these come last.
SsorOrder make_separated_groups(const linear::BlockMatrix& matrix, int count);

}  // namespace argil::bench
