#include "contact/bounding_tree.h"

#include "base/lanes.h"

namespace argil::contact {

BoundingTree::BoundingTree(const Points& vertices, const Triangles& triangles)
    : m_triangles(triangles),
      m_tree(mesh::compute_centroids(vertices, triangles)),
      m_triangle_boxes(m_tree.order().size() + 1) {
  m_passed.reserve(m_tree.order().size() + 1);
  fit_all(vertices);
}

void BoundingTree::fit_all(const Points& x) {
  if (m_tree.is_empty()) return;
  for (std::size_t n = m_tree.nodes().size(); n-- > 0;) {
    Node& node = m_tree.nodes()[n];
    node.kept.motion = -1.0;  // no motion summed so far: needs a fit
    node.kept.interval = -1;
    node.is_leaf() ? fit_leaf(node, x, x) : fit_inner(node);
  }
}

mesh::Box BoundingTree::fit_triangle(int triangle, const Points& x_t0, const Points& x_t1) const {
  mesh::Box box;
  for (int k = 0; k < 3; ++k) box.include(Vec3(x_t0.col(m_triangles(k, triangle))));
  if (&x_t0 == &x_t1) return box;
  for (int k = 0; k < 3; ++k) box.include(Vec3(x_t1.col(m_triangles(k, triangle))));
  return box;
}

namespace {

/// A box and what lies behind it in memory.
struct BoxLanes {
  Quad low, high;
};

ARGIL_INLINE void read_box(const mesh::Box& box, double margin, BoxLanes& lanes) {
  read(box.low.data(), lanes.low);
  read(box.high.data(), lanes.high);
  lanes.low -= margin;
  lanes.high += margin;
}

ARGIL_INLINE void spread(const mesh::Box& box, BoxLanes& lanes) {
  lanes.low = Quad{box.low(0), box.low(1), box.low(2), 0.0};
  lanes.high = Quad{box.high(0), box.high(1), box.high(2), 0.0};
}

ARGIL_INLINE bool overlaps(const BoxLanes& a, const BoxLanes& b) {
  const Quad under = a.high - b.low;
  const Quad over = b.high - a.low;
  const Quad both = under < over ? under : over;
  return (both[0] >= 0.0) & (both[1] >= 0.0) & (both[2] >= 0.0);
}

/// Square of the distance of a point from a box.
ARGIL_INLINE double square_distance(const BoxLanes& box, const Quad& p) {
  const Quad below = box.low - p;
  const Quad above = p - box.high;
  const Quad beside = below > above ? below : above;
  const Quad d = beside > 0.0 ? beside : Quad{};
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

}  // namespace

/// The triangles whose boxes, and all those around them, pass `is_met`(box, margin).
template <class Test>
ARGIL_INLINE void BoundingTree::find(Test is_met, const Points& x_t0, const Points& x_t1,
                                     std::vector<int>& triangles) {
  m_passed.clear();
  const auto enters = [&](int index) __attribute__((always_inline)) {
    const Node& node = m_tree.node(index);
    if (!is_met(node.box, margin(node))) return false;
    if (!node.is_leaf()) m_passed.push_back(index);
    return true;
  };
  const auto at_leaf = [&](int index) __attribute__((always_inline)) {
    Node& leaf = m_tree.node(index);
    fit_leaf(leaf, x_t0, x_t1);
    const auto last = static_cast<std::size_t>(leaf.first + leaf.count);
    for (auto i = static_cast<std::size_t>(leaf.first); i < last; ++i)
      if (is_met(m_triangle_boxes[i], 0.0)) triangles.push_back(m_tree.order()[i]);
  };
  m_tree.descend(enters, at_leaf);
  fit_passed();
}

ARGIL_EVERY_PROCESSOR void BoundingTree::find_overlaps(const mesh::Box& query, const Points& x_t0,
                                                       const Points& x_t1, std::vector<int>& triangles) {
  BoxLanes lanes;
  spread(query, lanes);
  const auto is_met = [&](const mesh::Box& box, double margin) __attribute__((always_inline)) {
    BoxLanes at;
    read_box(box, margin, at);
    return overlaps(lanes, at);
  };
  find(is_met, x_t0, x_t1, triangles);
}

ARGIL_EVERY_PROCESSOR void BoundingTree::find_overlaps(const mesh::Box& query, const Reach& reach,
                                                       const Points& x, std::vector<int>& triangles) {
  BoxLanes lanes;
  spread(query, lanes);
  const Quad centre = {reach.centre(0), reach.centre(1), reach.centre(2), 0.0};
  const auto is_met = [&](const mesh::Box& box, double margin) __attribute__((always_inline)) {
    BoxLanes at;
    read_box(box, margin, at);
    const Quad side = at.high - at.low;
    const double most = reach.radius + reach.per_side * (side[0] + side[1] + side[2]);
    return overlaps(lanes, at) && square_distance(at, centre) <= most * most;
  };
  find(is_met, x, x, triangles);
}

ARGIL_EVERY_PROCESSOR void BoundingTree::find_near(const Vec3& p, double squared_reach, const Points& x_t0,
                                                   const Points& x_t1, std::vector<int>& triangles) {
  triangles.clear();
  const Quad at = {p(0), p(1), p(2), 0.0};
  const auto is_near = [&](const mesh::Box& box, double margin) __attribute__((always_inline)) {
    BoxLanes lanes;
    read_box(box, margin, lanes);
    return square_distance(lanes, at) <= squared_reach;
  };
  find(is_near, x_t0, x_t1, triangles);
}

/// Children were passed after their parents.
ARGIL_CALLED_FROM_EVERY void BoundingTree::fit_passed() {
  for (auto index = m_passed.rbegin(); index != m_passed.rend(); ++index) fit_inner(m_tree.node(*index));
}

ARGIL_CALLED_FROM_EVERY void BoundingTree::fit_leaf(Node& leaf, const Points& x_t0, const Points& x_t1) {
  if (leaf.kept.interval == m_interval) return;
  leaf.box = mesh::Box();
  const auto last = static_cast<std::size_t>(leaf.first + leaf.count);
  for (auto i = static_cast<std::size_t>(leaf.first); i < last; ++i) {
    m_triangle_boxes[i] = fit_triangle(m_tree.order()[i], x_t0, x_t1);
    leaf.box.include(m_triangle_boxes[i]);
  }
  leaf.kept = {m_motion, m_interval};
}

void BoundingTree::fit_inner(Node& node) {
  if (node.kept.motion == m_motion) return;
  node.box = current(m_tree.node(node.first));
  node.box.include(current(m_tree.node(node.first + 1)));
  node.kept.motion = m_motion;
}

}  // namespace argil::contact
