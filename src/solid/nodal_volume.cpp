#include "solid/nodal_volume.h"

#include <algorithm>

#include "base/ordered_sum.h"
#include "base/parallel.h"

namespace argil::solid {

NodalVolume::NodalVolume(const Elements& elements, const std::vector<int>& row_of_node)
    : m_nodes(elements.nodes),
      m_node_begin(elements.node_begin),
      m_node_corners(elements.node_corners),
      m_row_of_node(row_of_node) {
  m_begin.push_back(0);
  for (const auto& ring : find_node_neighbours(elements)) {
    m_neighbour.insert(m_neighbour.end(), ring.begin(), ring.end());
    m_begin.push_back(static_cast<int>(m_neighbour.size()));
  }
  m_place.resize(static_cast<std::size_t>(16 * elements.num_tets()));
  for (int t = 0; t < elements.num_tets(); ++t)
    for (int a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(elements.nodes(a, t));
      const auto first = m_neighbour.begin() + m_begin[node];
      const auto last = m_neighbour.begin() + m_begin[node + 1];
      for (int j = 0; j < 4; ++j)
        m_place[static_cast<std::size_t>(16 * t + 4 * a + j)] =
            static_cast<int>(std::lower_bound(first, last, elements.nodes(j, t)) - m_neighbour.begin());
    }
  m_ring_gradient.setZero(3, static_cast<Eigen::Index>(m_neighbour.size()));
  m_weight.setZero(elements.num_tets());
}

void NodalVolume::set_excess(int tet, double excess_bulk, double volume) {
  m_weight(tet) = 0.25 * volume * excess_bulk;
  m_is_stale = true;
}

void NodalVolume::update_stiffness() {
  if (!m_is_stale) return;
  m_is_stale = false;
  m_stiffness.setZero(num_nodes());
  for (Eigen::Index t = 0; t < m_weight.size(); ++t)
    for (int a = 0; a < 4; ++a) m_stiffness(m_nodes(a, t)) += m_weight(t);
}

double NodalVolume::theta(int node, const Field& volume_change) const {
  if (m_stiffness(node) == 0.0) return 0.0;
  double sum = 0.0;
  for (int c = m_node_begin[static_cast<std::size_t>(node)];
       c < m_node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
    const int tet = m_node_corners[static_cast<std::size_t>(c)] / 4;
    sum += m_weight(tet) * volume_change(tet);
  }
  return sum / m_stiffness(node);
}

void NodalVolume::average(const Field& volume_change, Field& mean) const {
  Field at_node(num_nodes());
  for (int n = 0; n < num_nodes(); ++n) at_node(n) = theta(n, volume_change);
  mean.resize(m_nodes.cols());
  for (Eigen::Index t = 0; t < mean.size(); ++t) {
    const auto n = m_nodes.col(t);
    mean(t) = 0.25 * (at_node(n(0)) + at_node(n(1)) + at_node(n(2)) + at_node(n(3)));
  }
}

double NodalVolume::compute_energy(const Field& volume_change) const {
  return ordered_sum(num_nodes(), [&](std::ptrdiff_t n) {
    const double change = theta(static_cast<int>(n), volume_change);
    return 0.5 * m_stiffness(n) * change * change;
  });
}

std::vector<std::vector<int>> NodalVolume::find_row_neighbours() const {
  std::vector<std::vector<int>> rows;
  for (std::size_t i = 0; i < m_row_of_node.size(); ++i) {
    if (m_row_of_node[i] < 0) continue;
    std::vector<int>& list = rows.emplace_back();
    for (int a = m_begin[i]; a < m_begin[i + 1]; ++a) {
      const auto node = static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(a)]);
      for (int j = m_begin[node]; j < m_begin[node + 1]; ++j) {
        const int row = m_row_of_node[static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(j)])];
        if (row >= 0) list.push_back(row);
      }
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return rows;
}

void NodalVolume::connect(const linear::BlockMatrix& matrix) {
  m_block_begin.assign(1, 0);
  m_block.clear();
  for (std::size_t i = 0; i < m_row_of_node.size(); ++i)
    for (int a = m_begin[i]; a < m_begin[i + 1]; ++a) {
      const auto node = static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(a)]);
      for (int j = m_begin[node]; j < m_begin[node + 1] && m_row_of_node[i] >= 0; ++j) {
        const int row = m_row_of_node[static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(j)])];
        m_block.push_back(row < 0 ? -1 : linear::find_block(matrix, m_row_of_node[i], row));
      }
      m_block_begin.push_back(static_cast<int>(m_block.size()));
    }
}

void NodalVolume::collect_gradients(const Eigen::Matrix3Xd& gradient) {
  m_ring_gradient.setZero();
  for (Eigen::Index t = 0; t < m_nodes.cols(); ++t)
    for (int a = 0; a < 4; ++a)
      for (int j = 0; j < 4; ++j)
        m_ring_gradient.col(m_place[static_cast<std::size_t>(16 * t + 4 * a + j)]) +=
            m_weight(t) * gradient.col(4 * t + j);
}

void NodalVolume::add_stiffness(const Eigen::Matrix3Xd& gradient, double scale, int threads,
                                linear::BlockMatrix& matrix) {
  collect_gradients(gradient);
  parallel_for(num_nodes(), threads, [&](std::ptrdiff_t i) {
    if (m_row_of_node[static_cast<std::size_t>(i)] < 0) return;
    for (int a = m_begin[static_cast<std::size_t>(i)]; a < m_begin[static_cast<std::size_t>(i) + 1]; ++a) {
      const int node = m_neighbour[static_cast<std::size_t>(a)];
      if (m_stiffness(node) == 0.0) continue;
      const int first = m_begin[static_cast<std::size_t>(node)];
      const int last = m_begin[static_cast<std::size_t>(node) + 1];
      const auto self =
          std::lower_bound(m_neighbour.begin() + first, m_neighbour.begin() + last, static_cast<int>(i)) -
          m_neighbour.begin();
      const Vec3 own = scale / m_stiffness(node) * m_ring_gradient.col(self);
      const int* block = &m_block[static_cast<std::size_t>(m_block_begin[static_cast<std::size_t>(a)])];
      for (int j = first; j < last; ++j, ++block)
        if (*block >= 0) matrix.block(*block) += own * m_ring_gradient.col(j).transpose();
    }
  });
}

void NodalVolume::add_diagonal(const Eigen::Matrix3Xd& gradient, double scale, linear::BlockMatrix& matrix) {
  collect_gradients(gradient);
  for (int node = 0; node < num_nodes(); ++node)
    for (int j = m_begin[static_cast<std::size_t>(node)]; j < m_begin[static_cast<std::size_t>(node) + 1];
         ++j) {
      const int row = m_row_of_node[static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(j)])];
      if (row < 0 || m_stiffness(node) == 0.0) continue;
      matrix.block(matrix.diagonal[static_cast<std::size_t>(row)]) +=
          scale / m_stiffness(node) * m_ring_gradient.col(j) * m_ring_gradient.col(j).transpose();
    }
}

}  // namespace argil::solid
