#include "embed/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace argil::embed {
namespace {

constexpr int kLeafSize = 4;
constexpr int kMaxDepth = 64;  // halving 2³¹ triangles takes 31 levels

// A group looks like one dipole from beyond this many times its reach. Winding numbers are then right to a
// few hundredths, and only whether they pass a half matters.
constexpr double kFarFactor = 2.0;

double compute_box_distance(const Vec3& lower, const Vec3& upper, const Vec3& x) {
  return (lower - x).cwiseMax(x - upper).cwiseMax(0.0).norm();
}

}  // namespace

ClosestPoint find_closest_point(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 normal = (b - a).cross(c - a);
  const double twice_area = normal.squaredNorm();
  if (twice_area > 0.0) {
    const double wa = (b - x).cross(c - x).dot(normal) / twice_area;
    const double wb = (c - x).cross(a - x).dot(normal) / twice_area;
    const double wc = 1.0 - wa - wb;
    if (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) return {wa * a + wb * b + wc * c, Vec3(wa, wb, wc)};
  }
  const std::array<Vec3, 3> corner = {a, b, c};
  ClosestPoint best;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Vec3 edge = corner[j] - corner[i];
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp((x - corner[i]).dot(edge) / length, 0.0, 1.0) : 0.0;
    const Vec3 point = corner[i] + t * edge;
    const double distance = (x - point).squaredNorm();
    if (distance >= best_distance) continue;
    best_distance = distance;
    best.point = point;
    best.weights.setZero();
    best.weights(static_cast<Eigen::Index>(i)) = 1.0 - t;
    best.weights(static_cast<Eigen::Index>(j)) += t;
  }
  return best;
}

double compute_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 u = a - x;
  const Vec3 v = b - x;
  const Vec3 w = c - x;
  const double lu = u.norm();
  const double lv = v.norm();
  const double lw = w.norm();
  const double volume = u.dot(v.cross(w));
  const double rest = lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv;
  return 2.0 * std::atan2(volume, rest);
}

TriangleTree::TriangleTree(const mesh::TriangleMesh& surface)
    : m_surface(surface),
      m_radius(Field::Zero(surface.num_vertices())),
      m_order(static_cast<std::size_t>(surface.num_triangles())),
      m_centroid(3, surface.num_triangles()) {
  std::iota(m_order.begin(), m_order.end(), 0);
  for (int t = 0; t < surface.num_triangles(); ++t)
    m_centroid.col(t) =
        (surface.vertices.col(surface.triangles(0, t)) + surface.vertices.col(surface.triangles(1, t)) +
         surface.vertices.col(surface.triangles(2, t))) /
        3.0;
  m_nodes.reserve(m_order.size());
  if (!m_order.empty()) build(0, static_cast<int>(m_order.size()));
}

int TriangleTree::build(int first, int count) {
  const int index = static_cast<int>(m_nodes.size());
  m_nodes.emplace_back();
  m_nodes.back().first = first;
  m_nodes.back().count = count;
  summarise(m_nodes.back());
  if (count <= kLeafSize) return index;
  const auto begin = m_order.begin() + first;
  Vec3 lower = m_centroid.col(*begin);
  Vec3 upper = lower;
  std::for_each(begin, begin + count, [&](int t) {
    lower = lower.cwiseMin(m_centroid.col(t));
    upper = upper.cwiseMax(m_centroid.col(t));
  });
  Eigen::Index axis = 0;
  (upper - lower).maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [this, axis](int a, int b) {
    const double xa = m_centroid(axis, a);
    const double xb = m_centroid(axis, b);
    return xa != xb ? xa < xb : a < b;
  });
  build(first, half);
  const int right = build(first + half, count - half);
  m_nodes[static_cast<std::size_t>(index)].right = right;
  return index;
}

void TriangleTree::summarise(Node& node) const {
  node.lower.setConstant(std::numeric_limits<double>::infinity());
  node.upper = -node.lower;
  node.area_normal.setZero();
  Vec3 moment = Vec3::Zero();
  double area = 0.0;
  for (int i = node.first; i < node.first + node.count; ++i) {
    const int t = m_order[static_cast<std::size_t>(i)];
    const auto corners = m_surface.triangles.col(t);
    const Vec3 a = m_surface.vertices.col(corners(0));
    const Vec3 b = m_surface.vertices.col(corners(1));
    const Vec3 c = m_surface.vertices.col(corners(2));
    node.lower = node.lower.cwiseMin(a).cwiseMin(b).cwiseMin(c);
    node.upper = node.upper.cwiseMax(a).cwiseMax(b).cwiseMax(c);
    const Vec3 area_normal = 0.5 * (b - a).cross(c - a);
    node.area_normal += area_normal;
    moment += area_normal.norm() * m_centroid.col(t);
    area += area_normal.norm();
  }
  node.centre = area > 0.0 ? Vec3(moment / area) : Vec3(0.5 * (node.lower + node.upper));
  node.reach = 0.0;
  for (int i = node.first; i < node.first + node.count; ++i)
    for (int k = 0; k < 3; ++k) {
      const int v = m_surface.triangles(k, m_order[static_cast<std::size_t>(i)]);
      node.reach = std::max(node.reach, (m_surface.vertices.col(v) - node.centre).norm());
    }
}

void TriangleTree::set_radius(const Field& radius) {
  m_radius = radius;
  for (Node& node : m_nodes) {
    node.radius = 0.0;
    for (int i = node.first; i < node.first + node.count; ++i)
      for (int k = 0; k < 3; ++k)
        node.radius =
            std::max(node.radius, radius(m_surface.triangles(k, m_order[static_cast<std::size_t>(i)])));
  }
}

double TriangleTree::compute_distance(const Vec3& x, double limit) const {
  if (m_nodes.empty()) return limit;
  const auto bound = [this, &x](int index) {
    const Node& node = m_nodes[static_cast<std::size_t>(index)];
    return compute_box_distance(node.lower, node.upper, x) - node.radius;
  };
  struct Open {
    int node;
    double bound;
  };
  std::array<Open, kMaxDepth> open;
  std::size_t num_open = 0;
  open[num_open++] = {0, bound(0)};
  double smallest = limit;
  while (num_open > 0) {
    const Open top = open[--num_open];
    if (top.bound >= smallest) continue;
    const Node& node = m_nodes[static_cast<std::size_t>(top.node)];
    if (node.right >= 0) {  // the nearer child is taken first
      const Open left = {top.node + 1, bound(top.node + 1)};
      const Open right = {node.right, bound(node.right)};
      open[num_open++] = left.bound <= right.bound ? right : left;
      open[num_open++] = left.bound <= right.bound ? left : right;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const auto corners = m_surface.triangles.col(m_order[static_cast<std::size_t>(i)]);
      const Vec3 radius(m_radius(corners(0)), m_radius(corners(1)), m_radius(corners(2)));
      const ClosestPoint closest =
          find_closest_point(m_surface.vertices.col(corners(0)), m_surface.vertices.col(corners(1)),
                             m_surface.vertices.col(corners(2)), x);
      smallest = std::min(smallest, (x - closest.point).norm() - closest.weights.dot(radius));
      if (radius.maxCoeff() == radius.minCoeff()) continue;
      for (int k = 0; k < 3; ++k)  // a thick corner's ball can reach past the closest point's
        smallest = std::min(smallest, (x - m_surface.vertices.col(corners(k))).norm() - radius(k));
    }
  }
  return smallest;
}

double TriangleTree::compute_winding_number(const Vec3& x) const {
  if (m_nodes.empty()) return 0.0;
  std::array<int, kMaxDepth> open;
  std::size_t num_open = 0;
  open[num_open++] = 0;
  double solid_angle = 0.0;
  while (num_open > 0) {
    const int index = open[--num_open];
    const Node& node = m_nodes[static_cast<std::size_t>(index)];
    const Vec3 to_centre = node.centre - x;
    const double distance = to_centre.norm();
    if (distance > kFarFactor * node.reach) {
      solid_angle += node.area_normal.dot(to_centre) / (distance * distance * distance);
    } else if (node.right >= 0) {
      open[num_open++] = node.right;
      open[num_open++] = index + 1;
    } else {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const auto corners = m_surface.triangles.col(m_order[static_cast<std::size_t>(i)]);
        solid_angle +=
            compute_solid_angle(m_surface.vertices.col(corners(0)), m_surface.vertices.col(corners(1)),
                                m_surface.vertices.col(corners(2)), x);
      }
    }
  }
  return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace argil::embed
