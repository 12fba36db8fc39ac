#pragma once

#include <algorithm>
#include <vector>

#include "base/mandel.h"
#include "base/ordered_loops.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

/// Elastic strains of tets whose law finds them by a logarithm: found where they are first asked for, and
/// kept until the tet moves or flows.
class ElasticStrains {
 public:
  /// Of no tets: every law finds what it wants by itself.
  explicit ElasticStrains(Eigen::Index num_tets)
      : m_strain(6, num_tets), m_is_known(static_cast<std::size_t>((num_tets + kLanes - 1) / kLanes), 0) {}

  void forget(std::ptrdiff_t batch) { m_is_known[static_cast<std::size_t>(batch)] = 0; }
  void forget(const OrderedRuns& batches) {
    if (!is_empty())
      batches.each(m_strain.cols(), [this](std::ptrdiff_t begin, std::ptrdiff_t) { forget(begin / kLanes); });
  }
  void forget_all() { std::fill(m_is_known.begin(), m_is_known.end(), char{0}); }
  bool is_empty() const { return m_is_known.empty(); }
  ElasticArrays arrays() {
    return is_empty() ? ElasticArrays{} : ElasticArrays{m_strain.data(), m_is_known.data()};
  }

 private:
  TensorField m_strain;          // 11 22 33 23 13 12 as in the matrix, in the frame of R
  std::vector<char> m_is_known;  // of each run of kLanes tets
};

}  // namespace argil::solid
