#pragma once

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
  bool overlaps(const Bounds& other) const {
    return (low.array() <= other.high.array()).all() && (high.array() >= other.low.array()).all();
  }
};

/// Binary tree of boxes over a triangle mesh. Built once on the rest shape, refitted to moving vertices.
class BoundingTree {
 public:
  BoundingTree(const Points& vertices, const Triangles& triangles);

  /// Fits every box to the triangles at both ends of an interval; linear paths stay inside.
  void refit(const Points& x_t0, const Points& x_t1);

  const Bounds& bounds() const { return m_nodes.front().bounds; }

  /// Appends the triangles whose boxes overlap `query`, in an order that depends on the tree alone.
  void find_overlaps(const Bounds& query, std::vector<int>& triangles) const;

 private:
  struct Node {
    Bounds bounds;
    int first = 0;  // leaf: first triangle in m_order; inner: index of the left child, right is next
    int count = 0;  // leaf: number of triangles; inner: 0
  };
  void split(int node, int first, int count, const Points& centroids);

  Triangles m_triangles;
  std::vector<int> m_order;
  std::vector<Node> m_nodes;  // children after their parent
};

}  // namespace argil::contact
