#include "embed/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace argil::embed {
namespace {

// A group looks like one dipole from beyond this many times its reach. Winding numbers are then right to a
// few hundredths, and only whether they pass a half matters.
constexpr double kFarFactor = 2.0;

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
      m_centroid(mesh::compute_centroids(surface.vertices, surface.triangles)),
      m_tree(m_centroid,
             [this](Tree::Node& node, std::span<const int> triangles) { summarise(node, triangles); }) {}

void TriangleTree::summarise(Tree::Node& node, std::span<const int> triangles) const {
  Group& group = node.kept;
  Vec3 moment = Vec3::Zero();
  double area = 0.0;
  for (const int t : triangles) {
    const auto corners = m_surface.triangles.col(t);
    for (const int v : corners) node.box.include(m_surface.vertices.col(v));
    const Vec3 area_normal = mesh::compute_area_vector(m_surface.vertices, corners);
    group.area_normal += area_normal;
    moment += area_normal.norm() * m_centroid.col(t);
    area += area_normal.norm();
  }
  group.centre = area > 0.0 ? Vec3(moment / area) : Vec3(0.5 * (node.box.low + node.box.high));
  for (const int t : triangles)
    for (const int v : m_surface.triangles.col(t))
      group.reach = std::max(group.reach, (m_surface.vertices.col(v) - group.centre).norm());
}

void TriangleTree::set_radius(const Field& radius) {
  m_radius = radius;
  if (m_tree.is_empty()) return;
  for (std::size_t n = m_tree.nodes().size(); n-- > 0;) {  // children after their parent
    Tree::Node& node = m_tree.nodes()[n];
    double& largest = node.kept.radius;
    if (node.is_leaf()) {
      largest = 0.0;
      for (const int t : m_tree.triangles_of(node))
        for (const int v : m_surface.triangles.col(t)) largest = std::max(largest, radius(v));
    } else {
      largest = std::max(m_tree.node(node.first).kept.radius, m_tree.node(node.first + 1).kept.radius);
    }
  }
}

template <class AtTriangle>
void TriangleTree::look_near(const Vec3& x, bool is_thick, const double& smallest,
                             AtTriangle at_triangle) const {
  const auto bound = [&](int index) {
    const Tree::Node& node = m_tree.node(index);
    return node.box.distance(x) - (is_thick ? node.kept.radius : 0.0);
  };
  const auto is_near = [&](double distance) { return distance < smallest; };
  const auto at_leaf = [&](int index) {
    for (const int t : m_tree.triangles_of(m_tree.node(index))) {
      const Eigen::Vector3i corners = m_surface.triangles.col(t);
      at_triangle(t,
                  find_closest_point(m_surface.vertices.col(corners(0)), m_surface.vertices.col(corners(1)),
                                     m_surface.vertices.col(corners(2)), x));
    }
  };
  if (!m_tree.is_empty() && is_near(bound(0)))
    m_tree.descend_by_distance(bound, is_near, at_leaf, [](int) {});
}

double TriangleTree::compute_distance(const Vec3& x, double limit) const {
  double smallest = limit;
  look_near(x, true, smallest, [&](int t, const ClosestPoint& closest) {
    const auto corners = m_surface.triangles.col(t);
    const Vec3 radius(m_radius(corners(0)), m_radius(corners(1)), m_radius(corners(2)));
    smallest = std::min(smallest, (x - closest.point).norm() - closest.weights.dot(radius));
    if (radius.maxCoeff() == radius.minCoeff()) return;
    for (int k = 0; k < 3; ++k)  // a thick corner's ball can reach past the closest point's
      smallest = std::min(smallest, (x - m_surface.vertices.col(corners(k))).norm() - radius(k));
  });
  return smallest;
}

TriangleTree::Nearest TriangleTree::find_nearest(const Vec3& x, double limit) const {
  Nearest nearest;
  nearest.distance = limit;
  look_near(x, false, nearest.distance, [&](int t, const ClosestPoint& closest) {
    const double distance = (x - closest.point).norm();
    if (distance < nearest.distance) nearest = {distance, closest.point, t};
  });
  return nearest;
}

void TriangleTree::add_solid_angle(int index, const Vec3& x, double& sum) const {
  const Tree::Node& node = m_tree.node(index);
  const Vec3 to_centre = node.kept.centre - x;
  const double distance = to_centre.norm();
  if (distance > kFarFactor * node.kept.reach) {
    sum += node.kept.area_normal.dot(to_centre) / (distance * distance * distance);
  } else if (node.is_leaf()) {
    for (const int t : m_tree.triangles_of(node)) {
      const auto corners = m_surface.triangles.col(t);
      sum += compute_solid_angle(m_surface.vertices.col(corners(0)), m_surface.vertices.col(corners(1)),
                                 m_surface.vertices.col(corners(2)), x);
    }
  } else {
    add_solid_angle(node.first, x, sum);
    add_solid_angle(node.first + 1, x, sum);
  }
}

double TriangleTree::compute_winding_number(const Vec3& x) const {
  if (m_tree.is_empty()) return 0.0;
  double solid_angle = 0.0;
  add_solid_angle(0, x, solid_angle);
  return solid_angle / (4.0 * std::numbers::pi);
}

}  // namespace argil::embed
