#pragma once

#include <algorithm>
#include <vector>

#include "base/types.h"

namespace argil::sim {

/// Forces on few of many nodes [N].
class NodalForce {
 public:
  Points at;  ///< 3×n

  explicit NodalForce(Eigen::Index num_nodes)
      : at(Points::Zero(3, num_nodes)), m_is_listed(static_cast<std::size_t>(num_nodes), 0) {
    m_nodes.reserve(m_is_listed.size());
  }
  /// All others have none. Increasing, without repeats, once sort() was called.
  const std::vector<int>& nodes() const { return m_nodes; }
  /// It has, or may get, a force.
  void list(int node) {
    char& is_listed = m_is_listed[static_cast<std::size_t>(node)];
    if (is_listed == 0) m_nodes.push_back(node);
    is_listed = 1;
  }
  void add(int node, const Vec3& force) {
    list(node);
    at.col(node) += force;
  }
  void sort() { std::sort(m_nodes.begin(), m_nodes.end()); }
  void clear() {
    for (const int node : m_nodes) {
      at.col(node).setZero();
      m_is_listed[static_cast<std::size_t>(node)] = 0;
    }
    m_nodes.clear();
  }

 private:
  std::vector<int> m_nodes;
  std::vector<char> m_is_listed;
};

}  // namespace argil::sim
