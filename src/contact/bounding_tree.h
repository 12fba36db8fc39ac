#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace argil::contact {

/// Axis-aligned box.
struct Bounds {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);
  void include(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void include(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  Bounds grown(double margin) const { return {low.array() - margin, high.array() + margin}; }
  bool overlaps(const Bounds& other) const {
    return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
  }
  /// The same of this box grown by a margin; axis by axis, as most boxes are told apart by the first.
  bool overlaps(const Bounds& other, double margin) const {
    for (Eigen::Index k = 0; k < 3; ++k)
      if (low(k) - margin > other.high(k) || high(k) + margin < other.low(k)) return false;
    return true;
  }
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

/// Binary tree of boxes over a moving triangle mesh. Its shape is made once. Boxes are fitted late: a node
/// keeps the box of its last fit and the motion summed up to then; it is grown by the motion since, and
/// fitted anew only when a query reaches it. So a call costs what lies near the query, not the size of the
/// mesh.
class BoundingTree {
 public:
  BoundingTree(const Points& vertices, const Triangles& triangles);

  /// Fits every box to vertices at rest: a new start.
  void fit_all(const Points& x);

  /// The vertices move on; none by more than `bound` along any axis [m].
  void advance(double bound) {
    m_motion += bound;
    if (bound > 0.0 || !m_is_still) ++m_interval;
    m_is_still = bound == 0.0;
  }

  /// Box that holds the surface during the whole present motion.
  Bounds bounds() const { return current(m_nodes.front()); }

  /// Appends the triangles whose boxes over the present motion (both ends; linear paths stay inside) overlap
  /// `query`, in an order that depends on the tree alone, and fits the boxes it meets.
  void find_overlaps(const Bounds& query, const Points& x_t0, const Points& x_t1,
                     std::vector<int>& triangles);

  /// Finds the triangles whose boxes over the present motion come as near to `p` as the root of
  /// `squared_reach`.
  void find_near(const Vec3& p, double squared_reach, const Points& x_t0, const Points& x_t1,
                 std::vector<int>& triangles);

  /// Calls visit(triangle) → squared distance for triangles that may be nearer to `p`, at any time of the
  /// present motion, than the least one found so far, which starts as `least`. Fits the boxes it meets.
  template <class Visit>
  void visit_near(const Vec3& p, double least, const Points& x_t0, const Points& x_t1, Visit visit) {
    if (!m_order.empty()) visit_node(0, p, least, x_t0, x_t1, visit);
  }

 private:
  struct Node {
    Bounds bounds;
    double motion = 0.0;         // m_motion when the box was fitted
    std::int64_t interval = -1;  // leaf: of its triangles' boxes
    int first = 0;  // leaf: first triangle in m_order; inner: index of the left child, right is next
    int count = 0;  // leaf: number of triangles; inner: 0
  };
  /// By how much a node's box must be grown for the motion since its fit.
  double margin(const Node& node) const {
    // The factor takes up the rounding of the sum of many motions.
    return (m_motion - node.motion) * (1.0 + 1e-9) + 1e-12 * m_motion;
  }
  Bounds current(const Node& node) const { return node.bounds.grown(margin(node)); }
  void split(int node, int first, int count, const Points& centroids);
  Bounds fit_triangle(int triangle, const Points& x_t0, const Points& x_t1) const;
  void fit_leaf(Node& node, const Points& x_t0, const Points& x_t1);
  void fit_inner(Node& node);
  void fit_passed();
  template <class Test>
  void find(Test is_met, const Points& x_t0, const Points& x_t1, std::vector<int>& triangles);
  template <class Visit>
  void visit_node(int index, const Vec3& p, double& least, const Points& x_t0, const Points& x_t1,
                  Visit& visit) {
    // Equal distances are visited too, so that the answer does not depend on the tree; see find_nearest.
    constexpr double kRounding = 1.0 + 1e-12;
    Node& node = m_nodes[static_cast<std::size_t>(index)];
    if (node.count > 0) {
      fit_leaf(node, x_t0, x_t1);
      for (auto i = static_cast<std::size_t>(node.first);
           i < static_cast<std::size_t>(node.first + node.count); ++i)
        if (m_triangle_bounds[i].squared_distance(p) <= least * kRounding)
          least = std::min(least, visit(m_order[i]));
      return;
    }
    const int l = node.first;
    const auto distance = [&](int child) {
      const Node& of_child = m_nodes[static_cast<std::size_t>(child)];
      return of_child.bounds.squared_distance(p, margin(of_child));
    };
    const double left = distance(l);
    const double right = distance(l + 1);
    const int first = left <= right ? l : l + 1;
    if (std::min(left, right) <= least * kRounding) visit_node(first, p, least, x_t0, x_t1, visit);
    if (std::max(left, right) <= least * kRounding)
      visit_node(2 * l + 1 - first, p, least, x_t0, x_t1, visit);
    fit_inner(node);
  }

  Triangles m_triangles;
  std::vector<int> m_order;
  std::vector<Bounds>
      m_triangle_bounds;      // in that order, of a leaf's last fit; and one more, for reads beyond
  std::vector<Node> m_nodes;  // children after their parent
  std::vector<int> m_waiting, m_passed;  // working arrays of a query: nodes to look at; inner ones that were
  double m_motion = 0.0;
  std::int64_t m_interval = 0;
  bool m_is_still = false;  // throughout the present motion
};

}  // namespace argil::contact
