// One bad tet, on purpose.
#include "mesh/sliver.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "mesh/topology.h"

namespace argil::mesh {
namespace {

using Corners = std::array<Vec3, 4>;

Corners corners_of(const TetMesh& mesh, int tet) {
  Corners x;
  for (int i = 0; i < 4; ++i) x[static_cast<std::size_t>(i)] = mesh.vertices.col(mesh.tets(i, tet));
  return x;
}

/// Where `vertex` lies when the height of `tet` over its opposite face is `share` of what it is.
Vec3 lower_vertex(const TetMesh& mesh, int tet, int vertex, double share) {
  const Corners x = corners_of(mesh, tet);
  int apex = 0;
  while (mesh.tets(apex, tet) != vertex) ++apex;
  const auto corner = [&](int i) { return x[static_cast<std::size_t>((apex + i) % 4)]; };
  const Vec3 normal = (corner(2) - corner(1)).cross(corner(3) - corner(1)).normalized();
  const Vec3 height = normal.dot(corner(0) - corner(1)) * normal;
  return corner(0) - (1.0 - share) * height;
}

/// Moves `vertex`, one of each of `tets`, to x when none of them becomes flatter than `share`; else nothing
/// happens.
bool move_vertex(TetMesh& mesh, const std::vector<int>& tets, int vertex, const Vec3& x, double share) {
  const auto volumes = [&] {
    std::vector<double> v;
    for (const int t : tets) {
      const Corners c = corners_of(mesh, t);
      v.push_back(compute_tet_volume(c[0], c[1], c[2], c[3]));
    }
    return v;
  };
  const Vec3 was = mesh.vertices.col(vertex);
  const std::vector<double> before = volumes();
  mesh.vertices.col(vertex) = x;
  const std::vector<double> after = volumes();
  constexpr double kRounding = 1e-9;
  bool is_sound = true;
  for (std::size_t i = 0; i < tets.size(); ++i)
    is_sound = is_sound && after[i] > (std::min(share, 0.5) - kRounding) * before[i] && after[i] > 0.0;
  if (!is_sound) mesh.vertices.col(vertex) = was;
  return is_sound;
}

}  // namespace

void flatten_tet(TetMesh& mesh, double share) {
  const int num_vertices = mesh.num_vertices();
  std::vector<char> is_inside(static_cast<std::size_t>(num_vertices), 1);
  const Triangles boundary = make_topology(mesh).boundary;
  for (const int v : boundary.reshaped()) is_inside[static_cast<std::size_t>(v)] = 0;
  std::vector<std::vector<int>> tets_of(static_cast<std::size_t>(num_vertices));
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (const int v : mesh.tets.col(t)) tets_of[static_cast<std::size_t>(v)].push_back(t);

  const Vec3 lower = mesh.vertices.rowwise().minCoeff(), upper = mesh.vertices.rowwise().maxCoeff();
  const Vec3 top(0.5 * (lower(0) + upper(0)), 0.5 * (lower(1) + upper(1)), upper(2));
  std::vector<int> vertices(static_cast<std::size_t>(num_vertices));
  std::iota(vertices.begin(), vertices.end(), 0);
  std::stable_sort(vertices.begin(), vertices.end(), [&](int a, int b) {
    return (mesh.vertices.col(a) - top).norm() < (mesh.vertices.col(b) - top).norm();
  });
  for (const int v : vertices) {
    const auto place = static_cast<std::size_t>(v);
    if (!is_inside[place]) continue;
    for (const int t : tets_of[place])
      if (move_vertex(mesh, tets_of[place], v, lower_vertex(mesh, t, v, share), share)) return;
  }
  throw InputError("", "", "no vertex within the body can flatten a tet",
                   "take more tets, or leave the body's tets as they are");
}

}  // namespace argil::mesh
