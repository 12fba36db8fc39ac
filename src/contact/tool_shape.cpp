#include "contact/tool_shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "base/error.h"

namespace argil::contact {
namespace {

struct Builder {
  std::vector<Vec3> vertices;
  std::vector<Eigen::Vector3i> triangles;

  int add(const Vec3& p) {
    vertices.push_back(p);
    return static_cast<int>(vertices.size()) - 1;
  }
  mesh::TriangleMesh finish() const {
    mesh::TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i)
      mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
    for (std::size_t i = 0; i < triangles.size(); ++i)
      mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
    return mesh;
  }
};

/// A point of a profile in the half-plane (distance from the axis, height).
struct ProfilePoint {
  double r;
  double z;
};

/// Surface of revolution around z. The profile runs from the lowest point on the axis to the highest; inner
/// points have r > 0.
mesh::TriangleMesh revolve(const std::vector<ProfilePoint>& profile, int segments) {
  Builder b;
  const int bottom = b.add({0.0, 0.0, profile.front().z});
  const int rings = static_cast<int>(profile.size()) - 2;
  for (int k = 1; k <= rings; ++k)
    for (int s = 0; s < segments; ++s) {
      // Every other ring is turned by half a segment, so that triangles are near equilateral.
      const double angle = 2.0 * std::numbers::pi * (s + 0.5 * (k % 2)) / segments;
      const ProfilePoint& p = profile[static_cast<std::size_t>(k)];
      b.add({p.r * std::cos(angle), p.r * std::sin(angle), p.z});
    }
  const int top = b.add({0.0, 0.0, profile.back().z});
  const auto at = [&](int k, int s) { return 1 + (k - 1) * segments + (s + segments) % segments; };
  for (int s = 0; s < segments; ++s) {
    b.triangles.emplace_back(bottom, at(1, s + 1), at(1, s));
    b.triangles.emplace_back(top, at(rings, s), at(rings, s + 1));
    for (int k = 1; k < rings; ++k) {
      if (k % 2 == 1) {  // lower ring turned forward by half a segment
        b.triangles.emplace_back(at(k, s), at(k + 1, s + 1), at(k + 1, s));
        b.triangles.emplace_back(at(k, s), at(k, s + 1), at(k + 1, s + 1));
      } else {
        b.triangles.emplace_back(at(k, s), at(k + 1, s), at(k + 1, s - 1));
        b.triangles.emplace_back(at(k, s), at(k, s + 1), at(k + 1, s));
      }
    }
  }
  return b.finish();
}

/// Arc of a circle around (0, z0) from polar angle `from` to `to` (0: straight down), ends left out as asked.
void append_arc(std::vector<ProfilePoint>& profile, double radius, double z0, double from, double to,
                int pieces, bool with_ends) {
  for (int i = with_ends ? 0 : 1; i <= (with_ends ? pieces : pieces - 1); ++i) {
    const double angle = from + (to - from) * i / pieces;
    profile.push_back({radius * std::sin(angle), z0 - radius * std::cos(angle)});
  }
}

}  // namespace

mesh::TriangleMesh make_sphere_tool(double radius, int subdivisions) {
  Builder b;
  const double g = std::numbers::phi;
  for (const double u : {-1.0, 1.0})
    for (const double v : {-g, g})
      for (const Vec3& p : {Vec3(0, u, v), Vec3(u, v, 0), Vec3(v, 0, u)}) b.add(radius * p.normalized());
  // Faces are the triples of vertices at the icosahedron's edge length from each other.
  const double edge = 2.0 * radius / std::sqrt(1.0 + g * g);
  const auto adjacent = [&](int i, int j) {
    const Vec3 d = b.vertices[static_cast<std::size_t>(i)] - b.vertices[static_cast<std::size_t>(j)];
    return std::abs(d.norm() - edge) < 1e-6 * edge;
  };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        if (!adjacent(i, j) || !adjacent(j, k) || !adjacent(i, k)) continue;
        const Vec3& p = b.vertices[static_cast<std::size_t>(i)];
        const Vec3& q = b.vertices[static_cast<std::size_t>(j)];
        const Vec3& r = b.vertices[static_cast<std::size_t>(k)];
        b.triangles.push_back((q - p).cross(r - p).dot(p) > 0.0 ? Eigen::Vector3i(i, j, k)
                                                                : Eigen::Vector3i(i, k, j));
      }
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middle_of;
    const auto middle = [&](int i, int j) {
      const auto [place, is_new] = middle_of.try_emplace(std::minmax(i, j), 0);
      if (is_new) {
        const Vec3 sum = b.vertices[static_cast<std::size_t>(i)] + b.vertices[static_cast<std::size_t>(j)];
        place->second = b.add(radius * sum.normalized());
      }
      return place->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : b.triangles) {
      const int ab = middle(t(0), t(1));
      const int bc = middle(t(1), t(2));
      const int ca = middle(t(2), t(0));
      finer.insert(finer.end(), {{t(0), ab, ca}, {ab, t(1), bc}, {ca, bc, t(2)}, {ab, bc, ca}});
    }
    b.triangles = std::move(finer);
  }
  return b.finish();
}

mesh::TriangleMesh make_capsule_tool(double radius, double length, int segments) {
  const double half = 0.5 * std::numbers::pi;
  const int pieces = std::max(2, segments / 4);
  std::vector<ProfilePoint> profile;
  append_arc(profile, radius, 0.0, 0.0, half, pieces, true);
  const int along =
      std::max(1, static_cast<int>(std::lround(length / (2.0 * std::numbers::pi * radius / segments))));
  for (int i = 1; i < along; ++i) profile.push_back({radius, length * i / along});
  append_arc(profile, radius, length, half, 2.0 * half, pieces, true);
  profile.front().r = profile.back().r = 0.0;
  return revolve(profile, segments);
}

mesh::TriangleMesh make_stylus_tool(double tip_radius, double radius, double length, int segments) {
  // The tip's arc ends where the cone through (radius, length) touches it: with the cone's normal (cos s,
  // −sin s), radius·cos s − length·sin s = tip_radius.
  const double slope = std::acos(tip_radius / std::hypot(radius, length)) - std::atan2(length, radius);
  const double end = 0.5 * std::numbers::pi - slope;
  std::vector<ProfilePoint> profile;
  append_arc(profile, tip_radius, 0.0, 0.0, end, std::max(3, segments / 4), true);
  profile.front().r = 0.0;
  const ProfilePoint from = profile.back();
  const ProfilePoint to{radius, length};
  constexpr int kAlong = 8;
  for (int i = 1; i <= kAlong; ++i)
    profile.push_back({from.r + (to.r - from.r) * i / kAlong, from.z + (to.z - from.z) * i / kAlong});
  profile.push_back({0.0, length});
  return revolve(profile, segments);
}

void require_closed_surface(const mesh::TriangleMesh& surface, const std::string& file) {
  if (surface.num_triangles() < 4)
    throw InputError(file, "", "has " + std::to_string(surface.num_triangles()) + " triangles",
                     "a closed surface has at least 4");
  std::map<std::pair<int, int>, int> direction;  // half-edge → triangle
  double volume = 0.0;
  for (int t = 0; t < surface.num_triangles(); ++t) {
    const std::string place = "triangle " + std::to_string(t);
    const Eigen::Vector3i f = surface.triangles.col(t);
    if (f.minCoeff() < 0 || f.maxCoeff() >= surface.num_vertices())
      throw InputError(file, place, "uses a vertex that the file does not have", "give all vertices");
    const Vec3 a = surface.vertices.col(f(0));
    const Vec3 b = surface.vertices.col(f(1));
    const Vec3 c = surface.vertices.col(f(2));
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    constexpr double kFlat = 1e-12;  // height over length of a triangle that rounding cannot tell from a line
    if (!((b - a).cross(c - a).norm() > kFlat * longest))
      throw InputError(file, place, "has no area, or a coordinate that is not a number",
                       "remove triangles without area and join vertices at the same place");
    volume += a.dot(b.cross(c)) / 6.0;
    for (int k = 0; k < 3; ++k)
      if (!direction.emplace(std::pair(f(k), f((k + 1) % 3)), t).second)
        throw InputError(file, "edge " + std::to_string(f(k)) + "-" + std::to_string(f((k + 1) % 3)),
                         "is run along twice in the same direction",
                         "let every edge belong to two triangles with the same outside");
  }
  for (const auto& [edge, t] : direction)
    if (!direction.contains({edge.second, edge.first}))
      throw InputError(file, "edge " + std::to_string(edge.first) + "-" + std::to_string(edge.second),
                       "belongs to triangle " + std::to_string(t) + " only: the surface is open",
                       "close it: what is touched needs an inside");
  if (!(volume > 0.0))
    throw InputError(file, "", "encloses the volume " + std::to_string(volume) + " m3",
                     "turn the triangles round so that their normals point out");
}

}  // namespace argil::contact
