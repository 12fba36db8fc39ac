#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "mesh/box_tree.h"

namespace argil::contact {

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
  mesh::Box bounds() const { return current(m_tree.node(0)); }

  /// Appends the triangles whose boxes over the present motion (both ends; linear paths stay inside) overlap
  /// `query`, in an order that depends on the tree alone, and fits the boxes it meets.
  void find_overlaps(const mesh::Box& query, const Points& x_t0, const Points& x_t1,
                     std::vector<int>& triangles);

  /// A ball that boxes have to reach. One counts as nearer by so many times the sum of its three sides.
  struct Reach {
    Vec3 centre = Vec3::Zero();
    double radius = 0.0;    ///< [m]
    double per_side = 0.0;  ///< [–]
  };
  /// The same of a surface at rest at `x`, without those whose boxes do not reach the ball; in any order.
  void find_overlaps(const mesh::Box& query, const Reach& reach, const Points& x,
                     std::vector<int>& triangles);

  /// Finds the triangles whose boxes over the present motion come as near to `p` as the root of
  /// `squared_reach`.
  void find_near(const Vec3& p, double squared_reach, const Points& x_t0, const Points& x_t1,
                 std::vector<int>& triangles);

  /// Calls measure(triangle) → squared distance for triangles that may be nearer to `p`, at any time of the
  /// present motion, than the least one found so far, which starts as `least`. Fits the boxes it meets.
  template <class Measure>
  void measure_near(const Vec3& p, double least, const Points& x_t0, const Points& x_t1, Measure measure) {
    // Equal distances are measured too, so that the answer does not depend on the tree; see find_nearest.
    constexpr double kRounding = 1.0 + 1e-12;
    const auto distance = [&](int index) {
      const Node& node = m_tree.node(index);
      return node.box.squared_distance(p, margin(node));
    };
    const auto is_near = [&](double squared_distance) { return squared_distance <= least * kRounding; };
    const auto at_leaf = [&](int index) {
      Node& leaf = m_tree.node(index);
      fit_leaf(leaf, x_t0, x_t1);
      const auto last = static_cast<std::size_t>(leaf.first + leaf.count);
      for (auto i = static_cast<std::size_t>(leaf.first); i < last; ++i)
        if (is_near(m_triangle_boxes[i].squared_distance(p)))
          least = std::min(least, measure(m_tree.order()[i]));
    };
    m_tree.descend_by_distance(distance, is_near, at_leaf, [&](int index) { fit_inner(m_tree.node(index)); });
  }

 private:
  /// What is kept of a node's fit.
  struct Fit {
    double motion = 0.0;         // m_motion when the box was fitted
    std::int64_t interval = -1;  // leaf: of its triangles' boxes
  };
  using Node = mesh::BoxTree<Fit>::Node;

  /// By how much a node's box must be grown for the motion since its fit.
  double margin(const Node& node) const {
    // The factor takes up the rounding of the sum of many motions.
    return (m_motion - node.kept.motion) * (1.0 + 1e-9) + 1e-12 * m_motion;
  }
  mesh::Box current(const Node& node) const { return node.box.grown(margin(node)); }
  mesh::Box fit_triangle(int triangle, const Points& x_t0, const Points& x_t1) const;
  void fit_leaf(Node& node, const Points& x_t0, const Points& x_t1);
  void fit_inner(Node& node);
  void fit_passed();
  template <class Test>
  void find(Test is_met, const Points& x_t0, const Points& x_t1, std::vector<int>& triangles);

  Triangles m_triangles;
  mesh::BoxTree<Fit> m_tree;
  // In the tree's order, of a leaf's last fit; and one more, for reads beyond.
  std::vector<mesh::Box> m_triangle_boxes;
  std::vector<int> m_passed;  // working array of a query: inner nodes that it went through
  double m_motion = 0.0;
  std::int64_t m_interval = 0;
  bool m_is_still = false;  // throughout the present motion
};

}  // namespace argil::contact
