#include "sim/kept_pressure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace argil::sim {
namespace {

/// A third of the triangles around each vertex.
struct VertexAreas {
  VertexAreas(const Triangles& triangles, const Points& x, const Field& per_area)
      : area(Field::Zero(x.cols())), spring(area), edge(area) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const auto corners = triangles.col(t);
      const Vec3 a = x.col(corners(1)) - x.col(corners(0)), b = x.col(corners(2)) - x.col(corners(0));
      const double longest = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}));
      const double third = a.cross(b).norm() / 6.0;
      for (const int v : corners) {
        area(v) += third;
        spring(v) += per_area(t) * third;
        edge(v) = std::max(edge(v), longest);
      }
    }
  }
  double find_stiffness(int vertex) const { return spring(vertex) / area(vertex); }

  Field area;    ///< [m²]
  Field spring;  ///< κ times that [N/m]
  Field edge;    ///< longest [m]
};

/// A vertex near the tool.
struct PressedVertex {
  int vertex = -1;
  Vec3 outward = Vec3::Zero();  ///< of the tool
  double edge = 0.0;            ///< longest [m]
  double spring = 0.0;          ///< κ times its area [N/m]
  double wanted = 0.0;          ///< [N]
  double moved = 0.0;           ///< along `outward` [m]
};

/// Those as near to the tool as its facets may be deep.
std::vector<PressedVertex> list_vertices(const StandingTool& tool, const VertexAreas& of, const Points& x) {
  constexpr double kNear = 2.0;  // edges
  std::vector<PressedVertex> near;
  int face = 0;
  for (int v = 0; v < x.cols(); ++v) {
    if (!(of.spring(v) > 0.0)) continue;
    const Vec3 in_tool = tool.pose.orientation.conjugate() * (x.col(v) - tool.pose.position);
    const contact::ToolDistance found = tool.shape.find_distance(in_tool, face);
    if (std::abs(found.distance) < kNear * of.edge(v))
      near.push_back({v, tool.pose.orientation * found.outward, of.edge(v), of.spring(v), 0.0});
  }
  return near;
}

/// Shares the force of each point among the vertices about it, by their area, the less the farther they are,
/// as far as both reach; all of them are scaled to the tool's.
void set_wanted(const std::vector<PressedPoint>& before, const StandingTool& tool, const VertexAreas& of,
                const Points& x, std::vector<PressedVertex>& vertices) {
  if (vertices.empty()) return;
  std::vector<double> weights(vertices.size());
  for (const PressedPoint& point : before) {
    double sum = 0.0, least = std::numeric_limits<double>::infinity();
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const int v = vertices[i].vertex;
      const double squared = (point.place - x.col(v)).squaredNorm();
      weights[i] = of.area(v) * std::max(0.0, 1.0 - squared / (point.area + 2.0 * of.area(v)));
      sum += weights[i];
      if (squared < least) nearest = i;
      least = std::min(least, squared);
    }
    if (!(sum > 0.0)) sum = weights[nearest] = 1.0;
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i].wanted += point.force * weights[i] / sum;
  }
  Vec3 all = Vec3::Zero();
  for (const PressedVertex& vertex : vertices) all += vertex.wanted * vertex.outward;
  const double share = all.norm() > 0.0 ? tool.force / all.norm() : 0.0;
  for (PressedVertex& vertex : vertices) vertex.wanted *= share;
}

}  // namespace

std::vector<PressedPoint> list_pressed(const contact::Contacts& contacts, const Triangles& triangles,
                                       const Points& x, const Field& per_area) {
  const VertexAreas vertices(triangles, x, per_area);
  std::vector<PressedPoint> points;
  for (const contact::Contact& c : contacts.contacts) {
    // Triangles that press with their corners share these.
    const double stiffness = c.triangle >= 0 ? per_area(c.triangle) : vertices.find_stiffness(c.vertex[0]);
    const double area = c.spring / stiffness;
    const double force = c.force.norm();
    if (area > 0.0 && force > 0.0) points.push_back({c.point, force, area});
  }
  return points;
}

Points keep_pressure(const std::vector<PressedPoint>& before, const StandingTool& tool,
                     const Triangles& triangles, const Points& x, contact::PressureContact& law) {
  constexpr int kTimes = 40;
  constexpr double kEnough = 0.01;   // of the force, off in all
  constexpr double kAtOnce = 0.02;   // of an edge
  constexpr double kFarthest = 0.3;  // of an edge
  const VertexAreas areas(triangles, x, law.stiffness().per_area);
  std::vector<PressedVertex> vertices = list_vertices(tool, areas, x);
  set_wanted(before, tool, areas, x, vertices);
  Points moved = x;
  Field found(x.cols());
  contact::Contacts contacts;
  for (int i = 0; i < kTimes; ++i) {
    law.prepare(moved);
    law.find_contacts(moved, tool.pose, tool.pose, contact::Yielding::yes, contacts);
    found.setZero();
    for (const contact::Contact& c : contacts.contacts)
      for (std::size_t k = 0; k < 3; ++k)
        if (c.vertex[k] >= 0) found(c.vertex[k]) += c.weight[k] * c.force.norm();
    double off = 0.0;
    for (const PressedVertex& of : vertices) off += std::abs(found(of.vertex) - of.wanted);
    if (off < kEnough * tool.force) break;
    for (PressedVertex& of : vertices) {
      const double excess = found(of.vertex) - of.wanted;
      const double way = std::clamp(excess / of.spring, -kAtOnce * of.edge, kAtOnce * of.edge);
      const double to = std::clamp(of.moved + way, -kFarthest * of.edge, kFarthest * of.edge);
      moved.col(of.vertex) += (to - of.moved) * of.outward;
      of.moved = to;
    }
  }
  law.forget();
  return moved;
}

}  // namespace argil::sim
