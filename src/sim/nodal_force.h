#pragma once

#include <algorithm>
#include <vector>

#include "base/types.h"

namespace argil::sim {

/// Forces on few of many nodes [N].
struct NodalForce {
  Points at;               ///< 3×n
  std::vector<int> nodes;  ///< all others have none; once list() was called increasing, without repeats

  explicit NodalForce(Eigen::Index num_nodes) : at(Points::Zero(3, num_nodes)) {
    nodes.reserve(static_cast<std::size_t>(num_nodes));
  }
  void add(int node, const Vec3& force) {
    if (at.col(node).isZero(0.0)) nodes.push_back(node);
    at.col(node) += force;
  }
  void list() {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
  void clear() {
    for (const int node : nodes) at.col(node).setZero();
    nodes.clear();
  }
};

}  // namespace argil::sim
