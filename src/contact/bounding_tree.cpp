#include "contact/bounding_tree.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace argil::contact {

BoundingTree::BoundingTree(const Points& vertices, const Triangles& triangles) : m_triangles(triangles) {
  Points centroids(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    centroids.col(t) =
        (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) + vertices.col(triangles(2, t))) / 3.0;
  m_order.resize(static_cast<std::size_t>(triangles.cols()));
  std::iota(m_order.begin(), m_order.end(), 0);
  m_nodes.reserve(m_order.size() + 1);
  m_nodes.emplace_back();
  split(0, 0, static_cast<int>(m_order.size()), centroids);
  refit(vertices, vertices);
}

void BoundingTree::split(int node, int first, int count, const Points& centroids) {
  constexpr int kLeafSize = 4;
  if (count <= kLeafSize) {
    m_nodes[static_cast<std::size_t>(node)].first = first;
    m_nodes[static_cast<std::size_t>(node)].count = count;
    return;
  }
  Bounds bounds;
  for (int i = first; i < first + count; ++i)
    bounds.include(Vec3(centroids.col(m_order[static_cast<std::size_t>(i)])));
  Eigen::Index axis = 0;
  (bounds.high - bounds.low).maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(m_order.begin() + first, m_order.begin() + first + half, m_order.begin() + first + count,
                   [&](int a, int b) {
                     return centroids(axis, a) != centroids(axis, b) ? centroids(axis, a) < centroids(axis, b)
                                                                     : a < b;
                   });
  const int left = static_cast<int>(m_nodes.size());
  m_nodes[static_cast<std::size_t>(node)].first = left;
  m_nodes.emplace_back();
  m_nodes.emplace_back();
  split(left, first, half, centroids);
  split(left + 1, first + half, count - half, centroids);
}

void BoundingTree::refit(const Points& x_t0, const Points& x_t1) {
  for (std::size_t n = m_nodes.size(); n-- > 0;) {
    Node& node = m_nodes[n];
    node.bounds = Bounds();
    if (node.count == 0 && !m_order.empty()) {
      node.bounds.include(m_nodes[static_cast<std::size_t>(node.first)].bounds);
      node.bounds.include(m_nodes[static_cast<std::size_t>(node.first) + 1].bounds);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i)
      for (int k = 0; k < 3; ++k) {
        const int v = m_triangles(k, m_order[static_cast<std::size_t>(i)]);
        node.bounds.include(Vec3(x_t0.col(v)));
        node.bounds.include(Vec3(x_t1.col(v)));
      }
  }
}

void BoundingTree::find_overlaps(const Bounds& query, std::vector<int>& triangles) const {
  std::array<int, 64> stack;  // the tree is balanced: depth ≤ log₂ of the number of triangles + 1
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = m_nodes[static_cast<std::size_t>(stack[--depth])];
    if (!node.bounds.overlaps(query)) continue;
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i)
        triangles.push_back(m_order[static_cast<std::size_t>(i)]);
    } else if (!m_order.empty()) {
      stack[depth++] = node.first + 1;
      stack[depth++] = node.first;
    }
  }
}

}  // namespace argil::contact
