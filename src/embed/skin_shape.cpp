#include "embed/skin_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace argil::embed {

mesh::TriangleMesh with_all_vertices(const mesh::TriangleMesh& surface) {
  std::vector<bool> is_used(static_cast<std::size_t>(surface.num_vertices()), false);
  for (Eigen::Index i = 0; i < surface.triangles.size(); ++i)
    is_used[static_cast<std::size_t>(surface.triangles.data()[i])] = true;
  mesh::TriangleMesh all = surface;
  const auto num_loose = std::count(is_used.begin(), is_used.end(), false);
  all.triangles.conservativeResize(3, surface.num_triangles() + num_loose);
  Eigen::Index next = surface.num_triangles();
  for (int v = 0; v < surface.num_vertices(); ++v)
    if (!is_used[static_cast<std::size_t>(v)]) all.triangles.col(next++).setConstant(v);
  return all;
}

mesh::TriangleMesh split_long_edges(const mesh::TriangleMesh& surface, double longest) {
  std::vector<Vec3> x;
  for (const auto& place : surface.vertices.colwise()) x.push_back(place);
  std::vector<std::array<int, 3>> triangles;
  for (const auto& t : surface.triangles.colwise()) triangles.push_back({t(0), t(1), t(2)});
  std::map<std::pair<int, int>, int> middles;
  const auto at = [&x](int v) -> const Vec3& { return x[static_cast<std::size_t>(v)]; };
  for (std::size_t t = 0; t < triangles.size();) {
    std::array<int, 3> v = triangles[t];
    const auto length = [&](std::size_t k) { return (at(v[(k + 1) % 3]) - at(v[k])).norm(); };
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (length(i) > length(k)) k = i;
    if (!(length(k) > longest)) {
      ++t;
      continue;
    }
    const auto [found, is_new] =
        middles.try_emplace(std::minmax(v[k], v[(k + 1) % 3]), static_cast<int>(x.size()));
    if (is_new) x.push_back(0.5 * (at(v[k]) + at(v[(k + 1) % 3])));
    triangles.push_back({found->second, v[(k + 1) % 3], v[(k + 2) % 3]});
    triangles[t][(k + 1) % 3] = found->second;
  }
  mesh::TriangleMesh fine;
  fine.vertices.resize(3, static_cast<Eigen::Index>(x.size()));
  for (std::size_t v = 0; v < x.size(); ++v) fine.vertices.col(static_cast<Eigen::Index>(v)) = x[v];
  fine.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    fine.triangles.col(static_cast<Eigen::Index>(t)) = Eigen::Vector3i(triangles[t].data());
  return fine;
}

double compute_skin_volume(const mesh::TriangleMesh& skin) {
  const Vec3 origin = skin.vertices.rowwise().minCoeff();
  double volume = 0.0;
  for (const auto& t : skin.triangles.colwise())
    volume += (skin.vertices.col(t(0)) - origin)
                  .dot((skin.vertices.col(t(1)) - origin).cross(skin.vertices.col(t(2)) - origin)) /
              6.0;
  return std::abs(volume);
}

bool is_closed(const mesh::TriangleMesh& skin) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& t : skin.triangles.colwise())
    for (int k = 0; k < 3; ++k)
      if (t(k) != t((k + 1) % 3)) edges.push_back({t(k), t((k + 1) % 3)});
  std::sort(edges.begin(), edges.end());
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&edges](const std::array<int, 2>& edge) {
    const auto [low, high] = std::equal_range(edges.begin(), edges.end(), edge);
    const auto [back_low, back_high] =
        std::equal_range(edges.begin(), edges.end(), std::array<int, 2>{edge[1], edge[0]});
    return high - low == back_high - back_low;
  });
}

}  // namespace argil::embed
