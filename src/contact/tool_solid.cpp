#include "contact/tool_solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "contact/nearest.h"

namespace argil::contact {
namespace {

using Vec2 = Eigen::Vector2d;  // distance from the axis, height

/// A point's distance from a part of a profile and the way out there.
struct ProfileDistance {
  double distance = 0.0;
  Vec2 outward = Vec2::Zero();
};

ProfileDistance find_from_ball(const Vec2& from_centre, double radius) {
  const double length = from_centre.norm();
  return {length - radius, length > 0.0 ? Vec2(from_centre / length) : Vec2(0.0, -1.0)};
}

/// Tip and cone, without end. `normal`: of the cone.
ProfileDistance find_from_cone(const RoundTool& tool, const Vec2& normal, const Vec2& p) {
  const Vec2 along(-normal.y(), normal.x());
  if (along.dot(p) < 0.0) return find_from_ball(p, tool.tip_radius);
  return {normal.dot(p) - tool.tip_radius, normal};
}

ProfileDistance find_from_capsule(const RoundTool& tool, const Vec2& p) {
  if (p.x() == 0.0 && p.y() >= 0.0 && p.y() <= tool.length) return {-tool.tip_radius, Vec2(1.0, 0.0)};
  return find_from_ball(p - Vec2(0.0, std::clamp(p.y(), 0.0, tool.length)), tool.tip_radius);
}

/// Of a convex solid that is the part of a cone below a plane: the farther out of both, but beside their
/// common rim.
ProfileDistance find_from_stylus(const RoundTool& tool, const Vec2& normal, const Vec2& p) {
  const ProfileDistance side = find_from_cone(tool, normal, p);
  const ProfileDistance top{p.y() - tool.length, Vec2(0.0, 1.0)};
  const bool is_inside = side.distance <= 0.0 && top.distance <= 0.0;
  if (is_inside) return side.distance > top.distance ? side : top;
  const Vec2 rim(tool.end_radius, tool.length);
  if (p.y() >= tool.length && p.x() <= tool.end_radius) return top;
  const Vec2 along(-normal.y(), normal.x());
  if (side.distance > 0.0 && along.dot(p) <= along.dot(rim)) return side;
  return find_from_ball(p - rim, 0.0);
}

/// Of the cone that touches the ball of the tip and goes through the rim of the end, as make_stylus_tool has
/// it.
Vec2 find_cone_normal(const RoundTool& tool) {
  const double slope = std::acos(tool.tip_radius / std::hypot(tool.end_radius, tool.length)) -
                       std::atan2(tool.length, tool.end_radius);
  return {std::cos(slope), -std::sin(slope)};
}

}  // namespace

struct ToolSolid::Mesh {
  Points vertices;
  SurfaceFeatures features;
  BoundingTree tree;
  mesh::Box box;
};

ToolSolid::ToolSolid(const RoundTool& shape) : m_round(shape), m_thickness(shape.tip_radius) {
  ARGIL_ASSERT(shape.tip_radius > 0.0 && shape.length >= 0.0, shape.tip_radius, shape.length);
  const double end_reach = shape.is_flat ? 0.0 : shape.end_radius;
  m_centre.z() = 0.5 * (shape.length + end_reach - shape.tip_radius);
  const double half = 0.5 * (shape.length + end_reach + shape.tip_radius);
  m_radius = shape.is_flat ? std::hypot(half, shape.end_radius) : half;
  if (shape.is_flat) m_cone_normal = find_cone_normal(shape);
  list_balls_on_axis();
}

ToolSolid::ToolSolid(const mesh::TriangleMesh& surface)
    : m_mesh(std::make_unique<Mesh>(Mesh{surface.vertices,
                                         SurfaceFeatures(surface.triangles, surface.num_vertices()),
                                         BoundingTree(surface.vertices, surface.triangles),
                                         {}})) {
  const Vec3 low = surface.vertices.rowwise().minCoeff();
  const Vec3 high = surface.vertices.rowwise().maxCoeff();
  m_centre = 0.5 * (low + high);
  m_radius = (surface.vertices.colwise() - m_centre).colwise().norm().maxCoeff() * (1.0 + 1e-9);
  m_thickness = 0.5 * (high - low).minCoeff();
  m_mesh->box = {low, high};
  list_balls_in_mesh();
}

void ToolSolid::add_ball(const Vec3& centre) {
  int face = 0;
  const double radius = -find_distance(centre, face).distance;
  const auto holds = [&](const InnerBall& ball) { return (centre - ball.centre).norm() < 0.5 * ball.radius; };
  if (radius > 0.0 && std::none_of(m_inner_balls.begin(), m_inner_balls.end(), holds))
    m_inner_balls.push_back({centre, radius});
}

/// From the tip on, no farther apart than they are large.
void ToolSolid::list_balls_on_axis() {
  constexpr int kMost = 32;
  const double least_step = m_round->length / kMost;
  for (double z = 0.0; z <= m_round->length;) {
    add_ball({0.0, 0.0, z});
    z += std::max({least_step, m_inner_balls.back().radius, m_round->tip_radius});
  }
}

/// Halfway through the solid from some of its corners, along the normal.
void ToolSolid::list_balls_in_mesh() {
  constexpr Eigen::Index kMost = 32;
  const Points& x = m_mesh->vertices;
  Points normal = Points::Zero(3, x.cols());
  const Triangles& triangles = m_mesh->features.triangles;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vec3 a = x.col(triangles(0, t));
    const Vec3 area = (x.col(triangles(1, t)) - a).cross(x.col(triangles(2, t)) - a);
    for (const int v : triangles.col(t)) normal.col(v) += area;
  }
  add_ball(m_centre);
  const Eigen::Index stride = std::max<Eigen::Index>(1, x.cols() / kMost);
  for (Eigen::Index v = 0; v < x.cols(); v += stride) {
    const Vec3 inward = -normal.col(v).normalized();
    const double step = 0.02 * m_thickness;
    double depth = 0.0;
    int face = 0;
    for (double next = step; next < 2.0 * m_radius; next += step) {
      const double inside = -find_distance(x.col(v) + next * inward, face).distance;
      if (!(inside > 0.0)) break;
      depth = next;
      next += std::max(0.0, inside - step);
    }
    add_ball(x.col(v) + 0.5 * depth * inward);
  }
}

ToolSolid::~ToolSolid() = default;
ToolSolid::ToolSolid(ToolSolid&&) noexcept = default;

double ToolSolid::find_least_distance(const Vec3& p) const {
  return m_mesh ? m_mesh->box.distance(p) : (p - m_centre).norm() - m_radius;
}

ToolDistance ToolSolid::find_distance(const Vec3& p, int& face) {
  if (is_ball()) return find_from_ball(p);
  if (m_round) {
    const double from_axis = std::hypot(p.x(), p.y());
    const Vec2 at(from_axis, p.z());
    const ProfileDistance found =
        m_round->is_flat ? find_from_stylus(*m_round, m_cone_normal, at) : find_from_capsule(*m_round, at);
    const Vec3 radial = from_axis > 0.0 ? Vec3(p.x() / from_axis, p.y() / from_axis, 0.0) : Vec3::UnitX();
    return {found.distance, found.outward.x() * radial + found.outward.y() * Vec3::UnitZ()};
  }
  const SurfaceAt at{m_mesh->features, m_mesh->vertices, m_mesh->vertices};
  const SurfacePoint nearest = find_nearest(at, m_mesh->tree, p, face);
  face = nearest.face;
  const double distance = std::sqrt(nearest.squared_distance);
  const double sign = is_behind(at, nearest, p) ? -1.0 : 1.0;
  constexpr double kOnSurface = 1e-12;  // of the tool's size: there the way to the nearest place is rounding
  if (distance > kOnSurface * m_radius) return {sign * distance, sign * (p - nearest.point) / distance};
  return {sign * distance, compute_face_normal(at, nearest.face).normalized()};
}

}  // namespace argil::contact
