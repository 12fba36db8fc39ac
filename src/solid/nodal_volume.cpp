#include "solid/nodal_volume.h"

#include <algorithm>

#include "base/lanes.h"
#include "base/ordered_sum.h"

namespace argil::solid {

NodalVolume::NodalVolume(const Elements& elements, const std::vector<int>& row_of_node, int threads)
    : m_runs(threads),
      m_nodes(elements.nodes),
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
    for (int a = 0; a < 4; ++a)
      for (int j = 0; j < 4; ++j)
        m_place[static_cast<std::size_t>(16 * t + 4 * a + j)] =
            find_place(elements.nodes(a, t), elements.nodes(j, t));
  m_ring_gradient.setZero(4, static_cast<Eigen::Index>(m_neighbour.size()));
  m_weight.setZero(elements.num_tets());
}

int NodalVolume::find_place(int node, int neighbour) const {
  const auto first = m_neighbour.begin() + m_begin[static_cast<std::size_t>(node)];
  const auto last = m_neighbour.begin() + m_begin[static_cast<std::size_t>(node) + 1];
  return static_cast<int>(std::lower_bound(first, last, neighbour) - m_neighbour.begin());
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

void NodalVolume::average(const Field& volume_change, Field& mean) {
  m_theta.resize(num_nodes());
  m_runs.each(num_nodes(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t n = begin; n < end; ++n) m_theta(n) = theta(static_cast<int>(n), volume_change);
  });
  mean.resize(m_nodes.cols());
  m_runs.each(mean.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t t = begin; t < end; ++t) {
      const auto n = m_nodes.col(t);
      mean(t) = 0.25 * (m_theta(n(0)) + m_theta(n(1)) + m_theta(n(2)) + m_theta(n(3)));
    }
  });
}

double NodalVolume::compute_energy(const Field& volume_change) const {
  return ordered_sum(num_nodes(), [&](std::ptrdiff_t n) {
    const double change = theta(static_cast<int>(n), volume_change);
    return 0.5 * m_stiffness(n) * change * change;
  });
}

std::vector<std::vector<int>> NodalVolume::find_row_neighbours() const {
  const auto is_row = [](int row) { return row >= 0; };
  std::vector<std::vector<int>> rows(
      static_cast<std::size_t>(std::count_if(m_row_of_node.begin(), m_row_of_node.end(), is_row)));
  for (std::size_t i = 0; i < m_row_of_node.size(); ++i) {
    if (m_row_of_node[i] < 0) continue;
    std::vector<int>& list = rows[static_cast<std::size_t>(m_row_of_node[i])];
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

namespace {

/// Ring entries of a node with corners begin … end−1: Σ V κ/4 ∂θ/∂x of the tets' corners.
ARGIL_EVERY_PROCESSOR void add_corner_gradients(const int* corners, int begin, int end, const int* places,
                                                const double* weight, const double* gradient, double* ring) {
  for (int c = begin; c < end; ++c) {
    const std::ptrdiff_t corner = corners[c];
    const std::ptrdiff_t tet = corner / 4;
    for (int j = 0; j < 4; ++j) {
      const double* g = gradient + 12 * tet + 3 * j;
      double* sum = ring + 4 * static_cast<std::ptrdiff_t>(places[4 * corner + j]);
      Quad entry;
      read(sum, entry);
      entry += weight[tet] * Quad{g[0], g[1], g[2], 0.0};
      write(entry, sum);
    }
  }
}

}  // namespace

void NodalVolume::collect_gradients(const Eigen::Matrix3Xd& gradient) {
  m_runs.each(num_nodes(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (m_stiffness(static_cast<Eigen::Index>(n)) == 0.0) continue;  // no one asks for it
      m_ring_gradient.middleCols(m_begin[n], m_begin[n + 1] - m_begin[n]).setZero();
      add_corner_gradients(m_node_corners.data(), m_node_begin[n], m_node_begin[n + 1], m_place.data(),
                           m_weight.data(), gradient.data(), m_ring_gradient.data());
    }
  });
}

void NodalVolume::add_stiffness(double scale, linear::BlockMatrix& matrix) const {
  m_runs.each(num_nodes(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      if (m_row_of_node[i] < 0) continue;
      for (int a = m_begin[i]; a < m_begin[i + 1]; ++a) {
        const int node = m_neighbour[static_cast<std::size_t>(a)];
        if (m_stiffness(node) == 0.0) continue;
        const Vec3 own =
            scale / m_stiffness(node) * m_ring_gradient.col(find_place(node, static_cast<int>(i))).head<3>();
        const int* block = &m_block[static_cast<std::size_t>(m_block_begin[static_cast<std::size_t>(a)])];
        for (int j = m_begin[static_cast<std::size_t>(node)]; j < m_begin[static_cast<std::size_t>(node) + 1];
             ++j, ++block)
          if (*block >= 0) matrix.block(*block) += own * m_ring_gradient.col(j).head<3>().transpose();
      }
    }
  });
}

void NodalVolume::add_diagonal(double scale, linear::BlockMatrix& matrix) const {
  for (int node = 0; node < num_nodes(); ++node)
    for (int j = m_begin[static_cast<std::size_t>(node)]; j < m_begin[static_cast<std::size_t>(node) + 1];
         ++j) {
      const int row = m_row_of_node[static_cast<std::size_t>(m_neighbour[static_cast<std::size_t>(j)])];
      if (row < 0 || m_stiffness(node) == 0.0) continue;
      matrix.block(matrix.diagonal[static_cast<std::size_t>(row)]) +=
          scale / m_stiffness(node) * m_ring_gradient.col(j).head<3>() *
          m_ring_gradient.col(j).head<3>().transpose();
    }
}

}  // namespace argil::solid
