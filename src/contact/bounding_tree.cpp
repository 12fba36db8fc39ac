#include "contact/bounding_tree.h"

#include <algorithm>
#include <numeric>

namespace argil::contact {

BoundingTree::BoundingTree(const Points& vertices, const Triangles& triangles) : m_triangles(triangles) {
  Points centroids(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    centroids.col(t) =
        (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) + vertices.col(triangles(2, t))) / 3.0;
  m_order.resize(static_cast<std::size_t>(triangles.cols()));
  std::iota(m_order.begin(), m_order.end(), 0);
  m_triangle_bounds.resize(m_order.size());
  m_nodes.reserve(m_order.size() + 1);
  m_nodes.emplace_back();
  split(0, 0, static_cast<int>(m_order.size()), centroids);
  fit_all(vertices);
}

void BoundingTree::fit_all(const Points& x) {
  if (m_order.empty()) return;
  for (std::size_t n = m_nodes.size(); n-- > 0;) {
    Node& node = m_nodes[n];
    node.motion = -1.0;  // no motion summed so far: needs a fit
    node.interval = -1;
    node.count > 0 ? fit_leaf(node, x, x) : fit_inner(node);
  }
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

Bounds BoundingTree::fit_triangle(int triangle, const Points& x_t0, const Points& x_t1) const {
  Bounds bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.include(Vec3(x_t0.col(m_triangles(k, triangle))));
    bounds.include(Vec3(x_t1.col(m_triangles(k, triangle))));
  }
  return bounds;
}

void BoundingTree::visit(int index, const Bounds& query, const Points& x_t0, const Points& x_t1,
                         std::vector<int>& triangles) {
  Node& node = m_nodes[static_cast<std::size_t>(index)];
  if (!node.bounds.overlaps(query, margin(node))) return;
  if (node.count > 0) {
    fit_leaf(node, x_t0, x_t1);
    if (!node.bounds.overlaps(query, 0.0)) return;
    for (auto i = static_cast<std::size_t>(node.first); i < static_cast<std::size_t>(node.first + node.count);
         ++i)
      if (m_triangle_bounds[i].overlaps(query, 0.0)) triangles.push_back(m_order[i]);
  } else {
    visit(node.first, query, x_t0, x_t1, triangles);
    visit(node.first + 1, query, x_t0, x_t1, triangles);
    fit_inner(node);
  }
}

void BoundingTree::fit_leaf(Node& node, const Points& x_t0, const Points& x_t1) {
  if (node.interval == m_interval) return;
  node.bounds = Bounds();
  for (auto i = static_cast<std::size_t>(node.first); i < static_cast<std::size_t>(node.first + node.count);
       ++i) {
    m_triangle_bounds[i] = fit_triangle(m_order[i], x_t0, x_t1);
    node.bounds.include(m_triangle_bounds[i]);
  }
  node.motion = m_motion;
  node.interval = m_interval;
}

void BoundingTree::fit_inner(Node& node) {
  if (node.motion == m_motion) return;
  node.bounds = current(m_nodes[static_cast<std::size_t>(node.first)]);
  node.bounds.include(current(m_nodes[static_cast<std::size_t>(node.first) + 1]));
  node.motion = m_motion;
}

}  // namespace argil::contact
