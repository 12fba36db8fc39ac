#include "contact/bounding_tree.h"

#include <algorithm>
#include <numeric>

#include "base/lanes.h"

namespace argil::contact {

BoundingTree::BoundingTree(const Points& vertices, const Triangles& triangles) : m_triangles(triangles) {
  Points centroids(3, triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    centroids.col(t) =
        (vertices.col(triangles(0, t)) + vertices.col(triangles(1, t)) + vertices.col(triangles(2, t))) / 3.0;
  m_order.resize(static_cast<std::size_t>(triangles.cols()));
  std::iota(m_order.begin(), m_order.end(), 0);
  m_triangle_bounds.resize(m_order.size() + 1);
  m_nodes.reserve(m_order.size() + 1);
  m_waiting.reserve(m_order.size() + 1);
  m_passed.reserve(m_order.size() + 1);
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

namespace {

/// A box and what lies behind it in memory.
struct BoxLanes {
  Quad low, high;
};

ARGIL_INLINE void read_box(const Bounds& bounds, double margin, BoxLanes& box) {
  read(bounds.low.data(), box.low);
  read(bounds.high.data(), box.high);
  box.low -= margin;
  box.high += margin;
}

}  // namespace

/// The triangles whose boxes, and all those around them, pass `is_met`(box, margin).
template <class Test>
ARGIL_INLINE void BoundingTree::find(Test is_met, const Points& x_t0, const Points& x_t1,
                                     std::vector<int>& triangles) {
  m_waiting.clear();
  m_passed.clear();
  if (!m_order.empty() && is_met(m_nodes.front().bounds, margin(m_nodes.front()))) m_waiting.push_back(0);
  while (!m_waiting.empty()) {
    const int index = m_waiting.back();
    m_waiting.pop_back();
    Node& node = m_nodes[static_cast<std::size_t>(index)];
    if (node.count == 0) {
      m_passed.push_back(index);
      for (const int child : {node.first + 1, node.first}) {
        const Node& of_child = m_nodes[static_cast<std::size_t>(child)];
        if (is_met(of_child.bounds, margin(of_child))) m_waiting.push_back(child);
      }
      continue;
    }
    fit_leaf(node, x_t0, x_t1);
    const auto last = static_cast<std::size_t>(node.first + node.count);
    for (auto i = static_cast<std::size_t>(node.first); i < last; ++i)
      if (is_met(m_triangle_bounds[i], 0.0)) triangles.push_back(m_order[i]);
  }
  fit_passed();
}

ARGIL_EVERY_PROCESSOR void BoundingTree::find_overlaps(const Bounds& query, const Points& x_t0,
                                                       const Points& x_t1, std::vector<int>& triangles) {
  const Quad low = {query.low(0), query.low(1), query.low(2), 0.0};
  const Quad high = {query.high(0), query.high(1), query.high(2), 0.0};
  const auto overlaps = [&](const Bounds& bounds, double margin) __attribute__((always_inline)) {
    BoxLanes box;
    read_box(bounds, margin, box);
    const Quad under = high - box.low;
    const Quad over = box.high - low;
    const Quad both = under < over ? under : over;
    return (both[0] >= 0.0) & (both[1] >= 0.0) & (both[2] >= 0.0);
  };
  find(overlaps, x_t0, x_t1, triangles);
}

ARGIL_EVERY_PROCESSOR void BoundingTree::find_near(const Vec3& p, double squared_reach, const Points& x_t0,
                                                   const Points& x_t1, std::vector<int>& triangles) {
  triangles.clear();
  const Quad at = {p(0), p(1), p(2), 0.0};
  const auto is_near = [&](const Bounds& bounds, double margin) __attribute__((always_inline)) {
    BoxLanes box;
    read_box(bounds, margin, box);
    const Quad below = box.low - at;
    const Quad above = at - box.high;
    const Quad beside = below > above ? below : above;
    const Quad way = beside > 0.0 ? beside : Quad{};
    return way[0] * way[0] + way[1] * way[1] + way[2] * way[2] <= squared_reach;
  };
  find(is_near, x_t0, x_t1, triangles);
}

/// Children were passed after their parents.
ARGIL_CALLED_FROM_EVERY void BoundingTree::fit_passed() {
  for (auto index = m_passed.rbegin(); index != m_passed.rend(); ++index)
    fit_inner(m_nodes[static_cast<std::size_t>(*index)]);
}

ARGIL_CALLED_FROM_EVERY void BoundingTree::fit_leaf(Node& node, const Points& x_t0, const Points& x_t1) {
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
