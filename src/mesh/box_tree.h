#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "base/types.h"

namespace argil::mesh {

/// Axis-aligned box [m]; as it is made, it holds nothing.
struct Box {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);
  void include(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void include(const Box& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  Box grown(double margin) const { return {low.array() - margin, high.array() + margin}; }
  bool overlaps(const Box& other) const {
    return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
  }
  /// The same of this box grown by a margin; axis by axis, as most boxes are told apart by the first.
  bool overlaps(const Box& other, double margin) const {
    for (Eigen::Index k = 0; k < 3; ++k)
      if (low(k) - margin > other.high(k) || high(k) + margin < other.low(k)) return false;
    return true;
  }
  /// Of p from this box, 0 inside [m].
  double distance(const Vec3& p) const { return (low - p).cwiseMax(p - high).cwiseMax(0.0).norm(); }
  /// Square of the distance of p from this box grown by a margin [m²].
  double squared_distance(const Vec3& p, double margin = 0.0) const {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < 3; ++k) {
      // Values and not references to them, as std::max takes: these branch.
      const double below = low(k) - margin - p(k);
      const double above = p(k) - (high(k) + margin);
      const double beside = below > above ? below : above;
      const double d = beside > 0.0 ? beside : 0.0;
      sum += d * d;
    }
    return sum;
  }
};

/// Centre of gravity of every triangle [m], 3×m.
Points compute_centroids(const Points& vertices, const Triangles& triangles);

/// Puts the lower half of `list` first, by centroid along the axis on which the listed ones spread most;
/// equal ones by number. Returns the size of the lower half.
std::size_t halve_by_centroid(std::span<int> list, const Points& centroids);

/// Binary tree of boxes over the triangles of a surface. Its shape is made once, by halving at the median
/// centroid down to a few triangles. A node has the box of what lies below it, which is its user's to set,
/// and what else its user keeps of it.
template <class Kept>
class BoxTree {
 public:
  struct Node {
    Box box;
    Kept kept = {};
    int first = 0;  ///< leaf: first triangle in order(); inner: index of the left child, right is next
    int count = 0;  ///< leaf: number of triangles; inner: 0
    bool is_leaf() const { return count > 0; }
  };

  /// Calls make(node, its triangles) for each node before its triangles are halved, parents before children.
  template <class Make>
  BoxTree(const Points& centroids, Make make) : m_order(static_cast<std::size_t>(centroids.cols())) {
    std::iota(m_order.begin(), m_order.end(), 0);
    m_nodes.reserve(m_order.size() + 1);
    m_nodes.emplace_back();
    if (!m_order.empty()) split(0, 0, m_order.size(), centroids, make);
  }
  explicit BoxTree(const Points& centroids) : BoxTree(centroids, [](Node&, std::span<const int>) {}) {}

  bool is_empty() const { return m_order.empty(); }
  /// Triangles; those of a leaf stand side by side.
  const std::vector<int>& order() const { return m_order; }
  std::span<const int> triangles_of(const Node& leaf) const {
    return std::span(m_order).subspan(static_cast<std::size_t>(leaf.first),
                                      static_cast<std::size_t>(leaf.count));
  }
  /// Children stand after their parent; the root is the first, and stands alone in an empty tree.
  std::vector<Node>& nodes() { return m_nodes; }
  const std::vector<Node>& nodes() const { return m_nodes; }
  Node& node(int index) { return m_nodes[static_cast<std::size_t>(index)]; }
  const Node& node(int index) const { return m_nodes[static_cast<std::size_t>(index)]; }

  /// Calls at_leaf(index) for the leaves that enters(index) lets through with all the nodes around them, left
  /// before right. Both children are asked for as soon as their parent is entered.
  template <class Enters, class AtLeaf>
  ARGIL_INLINE void descend(Enters enters, AtLeaf at_leaf) const {
    if (is_empty() || !enters(0)) return;
    std::array<int, kMaxDepth> waiting;
    std::size_t num_waiting = 0;
    waiting[num_waiting++] = 0;
    while (num_waiting > 0) {
      const int index = waiting[--num_waiting];
      const Node& at = node(index);
      if (at.is_leaf()) {
        at_leaf(index);
        continue;
      }
      for (const int child : {at.first + 1, at.first})
        if (enters(child)) waiting[num_waiting++] = child;
    }
  }

  /// Calls at_leaf(index) for leaves, nearer ones first: those below children whose distance(index) is within
  /// what is_near(distance) takes when their turn has come. Calls at_end(index) for inner nodes when all
  /// below has been looked at.
  template <class Distance, class IsNear, class AtLeaf, class AtEnd>
  void descend_by_distance(Distance distance, IsNear is_near, AtLeaf at_leaf, AtEnd at_end) const {
    if (!is_empty()) descend_by_distance(0, distance, is_near, at_leaf, at_end);
  }

 private:
  static constexpr std::size_t kLeafSize = 4;
  static constexpr std::size_t kMaxDepth = 64;  // halving 2³¹ triangles takes 31 levels

  template <class Make>
  void split(int index, std::size_t first, std::size_t count, const Points& centroids, Make& make) {
    const std::span<int> list = std::span(m_order).subspan(first, count);
    make(node(index), std::span<const int>(list));
    if (count <= kLeafSize) {
      node(index).first = static_cast<int>(first);
      node(index).count = static_cast<int>(count);
      return;
    }
    const std::size_t half = halve_by_centroid(list, centroids);
    const int left = static_cast<int>(m_nodes.size());
    node(index).first = left;
    m_nodes.emplace_back();
    m_nodes.emplace_back();
    split(left, first, half, centroids, make);
    split(left + 1, first + half, count - half, centroids, make);
  }

  template <class Distance, class IsNear, class AtLeaf, class AtEnd>
  void descend_by_distance(int index, Distance& distance, IsNear& is_near, AtLeaf& at_leaf,
                           AtEnd& at_end) const {
    const Node& at = node(index);
    if (at.is_leaf()) {
      at_leaf(index);
      return;
    }
    const int left = at.first;
    const double to_left = distance(left);
    const double to_right = distance(left + 1);
    const bool is_left_first = to_left <= to_right;
    if (is_near(is_left_first ? to_left : to_right))
      descend_by_distance(is_left_first ? left : left + 1, distance, is_near, at_leaf, at_end);
    if (is_near(is_left_first ? to_right : to_left))
      descend_by_distance(is_left_first ? left + 1 : left, distance, is_near, at_leaf, at_end);
    at_end(index);
  }

  std::vector<int> m_order;
  std::vector<Node> m_nodes;
};

}  // namespace argil::mesh
