#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::test {

/// What a surface lacks of being closed and clean.
struct SurfaceReport {
  int num_vertices = 0;
  int num_triangles = 0;
  int num_boundary_edges = 0;      ///< edges of one triangle
  int num_non_manifold_edges = 0;  ///< edges of three or more, or of two with the same direction
  int num_degenerate = 0;          ///< triangles with area below round-off of their size
  bool is_closed() const { return num_boundary_edges == 0 && num_non_manifold_edges == 0; }
};

/// Triangles that name a vertex twice count as degenerate and have no edges.
inline SurfaceReport compute_surface_report(const mesh::TriangleMesh& surface) {
  constexpr double kRoundOff = 8.0 * std::numeric_limits<double>::epsilon();
  SurfaceReport report;
  report.num_vertices = surface.num_vertices();
  report.num_triangles = surface.num_triangles();
  std::map<std::pair<int, int>, std::vector<bool>>
      edges;  // by their vertices: the direction in each triangle
  for (const auto& v : surface.triangles.colwise()) {
    const Vec3 a = surface.vertices.col(v(0)), b = surface.vertices.col(v(1)), c = surface.vertices.col(v(2));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double farthest = std::max({a.norm(), b.norm(), c.norm()});
    const double area = 0.5 * (b - a).cross(c - a).norm();
    if (!(area > kRoundOff * (farthest + longest) * longest)) ++report.num_degenerate;
    if (v(0) == v(1) || v(1) == v(2) || v(2) == v(0)) continue;
    for (int i = 0; i < 3; ++i) {
      const int from = v(i), to = v((i + 1) % 3);
      edges[{std::min(from, to), std::max(from, to)}].push_back(from < to);
    }
  }
  for (const auto& [vertices, directions] : edges) {
    if (directions.size() == 1)
      ++report.num_boundary_edges;
    else if (directions.size() > 2 || directions[0] == directions[1])
      ++report.num_non_manifold_edges;
  }
  return report;
}

}  // namespace argil::test
