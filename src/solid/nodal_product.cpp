#include "solid/nodal_product.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/check.h"
#include "base/lanes.h"

namespace argil::solid {
namespace {

/// Four numbers at any address. Pointers to them, for Clang forgets the alignment of what a function returns
/// by reference.
template <class Real>
struct Four;
template <>
struct Four<float> {
  using At __attribute__((vector_size(16), aligned(4), may_alias)) = float;
};
template <>
struct Four<double> {
  using At __attribute__((vector_size(32), aligned(8), may_alias)) = double;
};
template <class Real>
ARGIL_INLINE const typename Four<Real>::At* four_at(const Real* at) {
  return reinterpret_cast<const typename Four<Real>::At*>(at);
}
template <class Real>
ARGIL_INLINE typename Four<Real>::At* four_at(Real* at) {
  return reinterpret_cast<typename Four<Real>::At*>(at);
}

// Templates for floats and double; in floats, which are there for speed, compiled for every processor below.

/// θ_a = Σ factor · x over the entries of nodes begin … end−1; returns Σ θ_a². Entries of even and odd places
/// apart, here and below: no sum waits for the one before it.
template <class Real>
ARGIL_INLINE double set_volume_changes(const int* node_begin, const int* row, const Real* factor,
                                       const Real* x, std::ptrdiff_t begin, std::ptrdiff_t end, Real* theta) {
  double squares = 0.0;
  for (std::ptrdiff_t a = begin; a < end; ++a) {
    typename Four<Real>::At even = {}, odd = {};
    const auto product = [&](std::ptrdiff_t e, auto& sum) __attribute__((always_inline)) {
      sum += *four_at(factor + 4 * e) * *four_at(x + 4 * static_cast<std::ptrdiff_t>(row[e]));
    };
    std::ptrdiff_t e = node_begin[a];
    for (; e + 1 < node_begin[a + 1]; e += 2) {
      product(e, even);
      product(e + 1, odd);
    }
    if (e < node_begin[a + 1]) product(e, even);
    even += odd;
    theta[a] = even[0] + even[1] + even[2];
    squares += static_cast<double>(theta[a]) * static_cast<double>(theta[a]);
  }
  return squares;
}

/// y += Σ factor θ_a over the entries of rows begin … end−1, four numbers a row.
template <class Real>
ARGIL_INLINE void add_volume_changes(const int* row_begin, const int* node, const Real* factor,
                                     const Real* theta, std::ptrdiff_t begin, std::ptrdiff_t end, Real* y) {
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    typename Four<Real>::At even = {}, odd = {};
    std::ptrdiff_t e = row_begin[row];
    for (; e + 1 < row_begin[row + 1]; e += 2) {
      even += *four_at(factor + 4 * e) * theta[node[e]];
      odd += *four_at(factor + 4 * e + 4) * theta[node[e + 1]];
    }
    if (e < row_begin[row + 1]) even += *four_at(factor + 4 * e) * theta[node[e]];
    *four_at(y + 4 * row) += even + odd;
  }
}

/// Blocks of rows begin … end−1 += Σ factor ⊗ factor.
template <class Real>
ARGIL_INLINE void add_squares(const int* row_begin, const Real* factor, std::ptrdiff_t begin,
                              std::ptrdiff_t end, double* blocks) {
  for (std::ptrdiff_t row = begin; row < end; ++row) {
    typename Four<Real>::At column[3] = {};
    for (std::ptrdiff_t e = row_begin[row]; e < row_begin[row + 1]; ++e)
      for (int k = 0; k < 3; ++k) column[k] += *four_at(factor + 4 * e) * factor[4 * e + k];
    for (int k = 0; k < 9; ++k) blocks[9 * row + k] += static_cast<double>(column[k / 3][k % 3]);
  }
}

ARGIL_EVERY_PROCESSOR double set_volume_changes(const int* node_begin, const int* row, const float* factor,
                                                const float* x, std::ptrdiff_t begin, std::ptrdiff_t end,
                                                float* theta) {
  return set_volume_changes<float>(node_begin, row, factor, x, begin, end, theta);
}
ARGIL_EVERY_PROCESSOR void add_volume_changes(const int* row_begin, const int* node, const float* factor,
                                              const float* theta, std::ptrdiff_t begin, std::ptrdiff_t end,
                                              float* y) {
  add_volume_changes<float>(row_begin, node, factor, theta, begin, end, y);
}
ARGIL_EVERY_PROCESSOR void add_squares(const int* row_begin, const float* factor, std::ptrdiff_t begin,
                                       std::ptrdiff_t end, double* blocks) {
  add_squares<float>(row_begin, factor, begin, end, blocks);
}

}  // namespace

NodalProduct::NodalProduct(const NodalVolume& nodal, const std::vector<int>& node_of_row,
                           const std::vector<int>& row_of_node, const Constraints& constraints, bool is_short,
                           int threads)
    : m_nodal(nodal), m_runs(threads), m_node_runs(threads), m_row_runs(threads), m_is_short(is_short) {
  const std::vector<int>& begin = nodal.ring_begin();
  const std::vector<int>& neighbour = nodal.ring();
  std::vector<int> entry_of_place(neighbour.size(), -1);
  m_node_begin.push_back(0);
  for (std::size_t a = 0; a + 1 < begin.size(); ++a) {
    for (int place = begin[a]; place < begin[a + 1]; ++place) {
      const int row = row_of_node[static_cast<std::size_t>(neighbour[static_cast<std::size_t>(place)])];
      if (row < 0) continue;
      entry_of_place[static_cast<std::size_t>(place)] = static_cast<int>(m_row.size());
      m_row.push_back(row);
      m_place.push_back(place);
    }
    m_node_begin.push_back(static_cast<int>(m_row.size()));
  }
  m_row_begin.push_back(0);
  for (const int i : node_of_row) {
    const auto node = static_cast<std::size_t>(i);
    for (int place = begin[node]; place < begin[node + 1]; ++place) {
      const int a = neighbour[static_cast<std::size_t>(place)];
      m_node.push_back(a);
      m_source.push_back(entry_of_place[static_cast<std::size_t>(nodal.find_place(a, i))]);
    }
    m_row_begin.push_back(static_cast<int>(m_node.size()));
    for (int k = 0; k < 3; ++k) m_is_free.push_back(constraints.support(k, i) < 0 ? 1.0 : 0.0);
    m_is_free.push_back(0.0);
  }
  m_busy_nodes.reserve(static_cast<std::size_t>(OrderedRuns::count_all_runs(num_nodes())));
  m_busy_rows.reserve(static_cast<std::size_t>(OrderedRuns::count_all_runs(num_rows())));
  const auto make_room = [&](auto& factors) {
    factors.by_node.resize(4 * m_row.size());
    factors.by_row.resize(4 * m_node.size());
    factors.x.resize(4 * node_of_row.size());
    factors.y.resize(4 * node_of_row.size());
    factors.theta.resize(begin.size() - 1);
  };
  if (is_short)
    make_room(m_short);
  else
    make_room(m_long);
}

void NodalProduct::update(double scale) {
  if (m_is_short)
    update_factors(scale, m_short);
  else
    update_factors(scale, m_long);
}

/// Runs without any such stiffness, of clay whose ν is low, would add zeros. True when the others changed.
bool NodalProduct::find_busy_runs() {
  const auto collect = [](std::vector<int>& runs, std::ptrdiff_t count, auto is_busy) {
    std::size_t found = 0;
    bool has_changed = false;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const auto run = static_cast<int>(i / OrderedRuns::kLength);
      if (!is_busy(i) || (found > 0 && runs[found - 1] == run)) continue;
      if (found == runs.size() || runs[found] != run) {
        runs.resize(found);
        runs.push_back(run);
        has_changed = true;
      }
      ++found;
    }
    has_changed = has_changed || found < runs.size();
    runs.resize(found);
    return has_changed;
  };
  const auto is_node_busy = [&](std::ptrdiff_t node) { return m_nodal.stiffness()(node) > 0.0; };
  const auto is_row_busy = [&](std::ptrdiff_t row) {
    const auto first = m_node.begin() + m_row_begin[static_cast<std::size_t>(row)];
    const auto last = m_node.begin() + m_row_begin[static_cast<std::size_t>(row) + 1];
    return std::any_of(first, last, is_node_busy);
  };
  // Rows by themselves: where nodes are held they are not in the runs of their nodes.
  const bool has_new_nodes = collect(m_busy_nodes, num_nodes(), is_node_busy);
  const bool has_new_rows = collect(m_busy_rows, num_rows(), is_row_busy);
  if (!has_new_nodes && !has_new_rows) return false;
  m_node_runs.restrict_to(&m_busy_nodes);
  m_row_runs.restrict_to(&m_busy_rows);
  return true;
}

template <class Real>
void NodalProduct::update_factors(double scale, Factors<Real>& factors) {
  if (find_busy_runs()) {  // those that are left out keep nothing that rows or their blocks would take
    std::fill(factors.theta.begin(), factors.theta.end(), Real{});
    std::fill(factors.by_node.begin(), factors.by_node.end(), Real{});
  }
  m_node_runs.each(num_nodes(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto a = static_cast<std::size_t>(begin); a < static_cast<std::size_t>(end); ++a) {
      const double stiffness = m_nodal.stiffness()(static_cast<Eigen::Index>(a));
      const double root = stiffness > 0.0 ? std::sqrt(scale / stiffness) : 0.0;
      for (auto e = static_cast<std::size_t>(m_node_begin[a]);
           e < static_cast<std::size_t>(m_node_begin[a + 1]); ++e) {
        const double* gradient = m_nodal.ring_gradient(m_place[e]);
        const double* is_free = &m_is_free[4 * static_cast<std::size_t>(m_row[e])];
        for (std::size_t k = 0; k < 4; ++k)
          factors.by_node[4 * e + k] = static_cast<Real>(root * gradient[k] * is_free[k]);
      }
    }
  });
  m_row_runs.each(num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto e = static_cast<std::size_t>(m_row_begin[static_cast<std::size_t>(begin)]);
         e < static_cast<std::size_t>(m_row_begin[static_cast<std::size_t>(end)]); ++e)
      std::copy_n(&factors.by_node[4 * static_cast<std::size_t>(m_source[e])], 4, &factors.by_row[4 * e]);
  });
}

double NodalProduct::add(const Points& x, Points& y) {
  return m_is_short ? add_product(x, m_short, y) : add_product(x, m_long, y);
}

double NodalProduct::add(const float* x, float* y) {
  ARGIL_ASSERT(m_is_short);
  return add_product(x, m_short, y);
}

template <class Real>
double NodalProduct::add_product(const Points& x, Factors<Real>& factors, Points& y) {
  m_runs.each(num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k)
        factors.x.data()[4 * row + k] = static_cast<Real>(x.data()[3 * row + k]);
  });
  std::fill(factors.y.begin(), factors.y.end(), Real{});
  const double product = add_product(factors.x.data(), factors, factors.y.data());
  m_runs.each(num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t row = begin; row < end; ++row)
      for (std::ptrdiff_t k = 0; k < 3; ++k)
        y.data()[3 * row + k] += static_cast<double>(factors.y.data()[4 * row + k]);
  });
  return product;
}

template <class Real>
double NodalProduct::add_product(const Real* x, Factors<Real>& factors, Real* y) {
  const double squares = m_node_runs.sum(num_nodes(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return set_volume_changes(m_node_begin.data(), m_row.data(), factors.by_node.data(), x, begin, end,
                              factors.theta.data());
  });
  m_row_runs.each(num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    add_volume_changes(m_row_begin.data(), m_node.data(), factors.by_row.data(), factors.theta.data(), begin,
                       end, y);
  });
  return squares;
}

void NodalProduct::add_diagonal(Eigen::Matrix3Xd& blocks) const {
  m_row_runs.each(num_rows(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (m_is_short)
      add_squares(m_row_begin.data(), m_short.by_row.data(), begin, end, blocks.data());
    else
      add_squares(m_row_begin.data(), m_long.by_row.data(), begin, end, blocks.data());
  });
}

}  // namespace argil::solid
