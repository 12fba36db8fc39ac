#pragma once

// Measures of meshes by their definitions, slow and plain, for use as references in tests.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "mesh/tet_mesh.h"
#include "mesh/topology.h"

namespace argil::test {

struct AngleRange {
  double smallest = 180.0;  ///< [degrees]
  double largest = 0.0;
};

/// Angles between the faces of all tets [degrees].
inline AngleRange compute_dihedral_range(const mesh::TetMesh& mesh) {
  AngleRange range;
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const int k = (i == 0 || j == 0) ? ((i == 1 || j == 1) ? 2 : 1) : 0;
        const int l = 6 - i - j - k;
        const Vec3 a = mesh.vertices.col(mesh.tets(i, t));
        const Vec3 along = (mesh.vertices.col(mesh.tets(j, t)) - a).normalized();
        const Vec3 c = mesh.vertices.col(mesh.tets(k, t)) - a;
        const Vec3 d = mesh.vertices.col(mesh.tets(l, t)) - a;
        const Vec3 u = c - along * along.dot(c);
        const Vec3 v = d - along * along.dot(d);
        const double angle = std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / std::acos(-1.0);
        range.smallest = std::min(range.smallest, angle);
        range.largest = std::max(range.largest, angle);
      }
  return range;
}

/// ∮ x·n dA / 3 over a surface [m³]: the volume it encloses when it is closed and its normals point out.
inline double compute_enclosed_volume(const Points& vertices, const Triangles& triangles) {
  double volume = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vec3 a = vertices.col(triangles(0, t));
    const Vec3 b = vertices.col(triangles(1, t));
    const Vec3 c = vertices.col(triangles(2, t));
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

inline double compute_area(const Points& vertices, const Triangles& triangles) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vec3 a = vertices.col(triangles(0, t));
    const Vec3 b = vertices.col(triangles(1, t));
    const Vec3 c = vertices.col(triangles(2, t));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

struct SurfaceFacts {
  bool is_manifold = true;  ///< each edge has two triangles of opposite direction, each vertex one closed fan
  int euler_characteristic = 0;   ///< vertices in use − edges + triangles
  double sharpest_edge = 0.0;     ///< largest angle between neighbouring normals [degrees]
  double smallest_angle = 180.0;  ///< of any triangle corner [degrees]
};

inline SurfaceFacts compute_surface_facts(const Points& vertices, const Triangles& triangles) {
  SurfaceFacts facts;
  std::map<std::pair<int, int>, std::vector<Eigen::Index>> edges;  // directed
  std::map<int, std::map<int, int>> next;                          // around a vertex: spoke to spoke
  const auto normal = [&](Eigen::Index t) -> Vec3 {
    const Vec3 a = vertices.col(triangles(0, t));
    const Vec3 b = vertices.col(triangles(1, t));
    const Vec3 c = vertices.col(triangles(2, t));
    return (b - a).cross(c - a).normalized();
  };
  const double degrees = 180.0 / std::acos(-1.0);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(i, t);
      const int b = triangles((i + 1) % 3, t);
      const int c = triangles((i + 2) % 3, t);
      edges[{a, b}].push_back(t);
      if (!next[a].emplace(b, c).second) facts.is_manifold = false;
      const Vec3 u = vertices.col(b) - vertices.col(a);
      const Vec3 v = vertices.col(c) - vertices.col(a);
      facts.smallest_angle =
          std::min(facts.smallest_angle, std::atan2(u.cross(v).norm(), u.dot(v)) * degrees);
    }
  for (const auto& [edge, users] : edges) {
    const auto twin = edges.find({edge.second, edge.first});
    if (users.size() != 1 || twin == edges.end() || twin->second.size() != 1) {
      facts.is_manifold = false;
      continue;
    }
    const Vec3 a = normal(users[0]);
    const Vec3 b = normal(twin->second[0]);
    facts.sharpest_edge = std::max(facts.sharpest_edge, std::atan2(a.cross(b).norm(), a.dot(b)) * degrees);
  }
  for (const auto& [vertex, spokes] : next) {
    std::size_t length = 0;
    int spoke = spokes.begin()->first;
    do {
      const auto on = spokes.find(spoke);
      if (on == spokes.end()) break;
      spoke = on->second;
      ++length;
    } while (spoke != spokes.begin()->first && length <= spokes.size());
    if (length != spokes.size()) facts.is_manifold = false;
  }
  facts.euler_characteristic =
      static_cast<int>(next.size()) - static_cast<int>(edges.size() / 2) + static_cast<int>(triangles.cols());
  return facts;
}

/// Parts that hang together by faces.
inline int count_components(const mesh::TetMesh& mesh) {
  const mesh::Topology topology = mesh::make_topology(mesh);
  std::vector<bool> seen(static_cast<std::size_t>(mesh.num_tets()), false);
  int count = 0;
  for (int start = 0; start < mesh.num_tets(); ++start) {
    if (seen[static_cast<std::size_t>(start)]) continue;
    ++count;
    std::vector<int> open = {start};
    seen[static_cast<std::size_t>(start)] = true;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (int i = 0; i < 4; ++i) {
        const int n = topology.neighbours(i, t);
        if (n < 0 || seen[static_cast<std::size_t>(n)]) continue;
        seen[static_cast<std::size_t>(n)] = true;
        open.push_back(n);
      }
    }
  }
  return count;
}

/// Slope of the least-squares line through (log x, log y).
inline double fit_order(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]);
    const double b = std::log(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

inline std::string hash_mesh(const Points& vertices, const int* indices, std::size_t count) {
  Sha256 hash;
  hash.add(vertices.data(), static_cast<std::size_t>(vertices.size()));
  hash.add(std::as_bytes(std::span(indices, count)));
  return hash.hex_digest();
}
inline std::string hash_mesh(const mesh::TetMesh& mesh) {
  return hash_mesh(mesh.vertices, mesh.tets.data(), static_cast<std::size_t>(mesh.tets.size()));
}
inline std::string hash_mesh(const mesh::TriangleMesh& mesh) {
  return hash_mesh(mesh.vertices, mesh.triangles.data(), static_cast<std::size_t>(mesh.triangles.size()));
}

}  // namespace argil::test
