#pragma once

#include <algorithm>
#include <vector>

#include "base/mandel.h"
#include "base/ordered_loops.h"
#include "solid/elements.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

/// Elastic strains of points whose law finds them by a logarithm: found where they are first asked for, and
/// kept until the tet moves or flows.
class ElasticStrains {
 public:
  /// `is_kept`: else of no points, and every law finds what it wants by itself.
  ElasticStrains(const Elements& elements, bool is_kept)
      : m_num_tets(is_kept ? elements.num_tets() : 0),
        m_points_per_tet(elements.points_per_tet),
        m_strain(6, m_points_per_tet * m_num_tets),
        m_is_known(static_cast<std::size_t>((m_strain.cols() + kLanes - 1) / kLanes), 0) {}

  /// Of a run of kLanes tets.
  void forget(std::ptrdiff_t batch) {
    const auto first = static_cast<std::size_t>(m_points_per_tet * batch);
    const std::size_t last = std::min(first + static_cast<std::size_t>(m_points_per_tet), m_is_known.size());
    std::fill(m_is_known.begin() + static_cast<std::ptrdiff_t>(first),
              m_is_known.begin() + static_cast<std::ptrdiff_t>(last), char{0});
  }
  void forget(const OrderedRuns& batches) {
    if (!is_empty())
      batches.each(m_num_tets, [this](std::ptrdiff_t begin, std::ptrdiff_t) { forget(begin / kLanes); });
  }
  void forget_all() { std::fill(m_is_known.begin(), m_is_known.end(), char{0}); }
  bool is_empty() const { return m_is_known.empty(); }
  ElasticArrays arrays() {
    return is_empty() ? ElasticArrays{} : ElasticArrays{m_strain.data(), m_is_known.data()};
  }

 private:
  Eigen::Index m_num_tets, m_points_per_tet;
  TensorField m_strain;          // 11 22 33 23 13 12 as in the matrix, in the frame of R
  std::vector<char> m_is_known;  // of each run of kLanes points
};

}  // namespace argil::solid
