#include "contact/surface_features.h"

#include <algorithm>
#include <array>

namespace argil::contact {
namespace {

std::vector<int> find_parts(const Triangles& triangle_edges, const Eigen::Matrix2Xi& edge_triangles) {
  std::vector<int> first;
  std::vector<int> next;
  std::vector<bool> is_seen(static_cast<std::size_t>(triangle_edges.cols()), false);
  const auto see = [&](int f) {
    if (is_seen[static_cast<std::size_t>(f)]) return false;
    is_seen[static_cast<std::size_t>(f)] = true;
    next.push_back(f);
    return true;
  };
  for (int f = 0; f < static_cast<int>(triangle_edges.cols()); ++f) {
    if (!see(f)) continue;
    first.push_back(f);
    while (!next.empty()) {
      const int present = next.back();
      next.pop_back();
      for (int k = 0; k < 3; ++k)
        for (int side = 0; side < 2; ++side) see(edge_triangles(side, triangle_edges(k, present)));
    }
  }
  return first;
}

}  // namespace

SurfaceFeatures::SurfaceFeatures(const Triangles& t, int num_vertices)
    : triangles(t), vertex_owner(static_cast<std::size_t>(num_vertices), -1) {
  const int m = static_cast<int>(t.cols());
  std::vector<std::array<int, 3>> found;  // lower vertex, higher vertex, 3·triangle + side
  std::vector<std::vector<int>> around(static_cast<std::size_t>(num_vertices));
  for (int f = 0; f < m; ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = t(k, f);
      const int b = t((k + 1) % 3, f);
      found.push_back({std::min(a, b), std::max(a, b), 3 * f + k});
      around[static_cast<std::size_t>(a)].push_back(f);
      if (vertex_owner[static_cast<std::size_t>(a)] < 0) vertex_owner[static_cast<std::size_t>(a)] = f;
    }
  std::sort(found.begin(), found.end());
  triangle_edges.resize(3, m);
  edges.resize(2, static_cast<Eigen::Index>(found.size()));
  edge_triangles.resize(2, static_cast<Eigen::Index>(found.size()));
  Eigen::Index e = -1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& [a, b, side] = found[i];
    if (i == 0 || a != found[i - 1][0] || b != found[i - 1][1]) {
      ++e;
      edges.col(e) << a, b;
      edge_triangles.col(e).setConstant(side / 3);
      edge_owner.push_back(side / 3);
    } else {
      edge_triangles(1, e) = side / 3;
    }
    triangle_edges(side % 3, side / 3) = static_cast<int>(e);
  }
  edges.conservativeResize(2, e + 1);
  edge_triangles.conservativeResize(2, e + 1);
  edge_opposite.resize(2, e + 1);
  for (Eigen::Index i = 0; i <= e; ++i)
    for (Eigen::Index k = 0; k < 2; ++k) {
      const Eigen::Vector3i f = t.col(edge_triangles(k, i));
      edge_opposite(k, i) = f.sum() - edges(0, i) - edges(1, i);
    }

  fan_begin.push_back(0);
  for (const std::vector<int>& of_vertex : around) {
    fan.insert(fan.end(), of_vertex.begin(), of_vertex.end());
    fan_begin.push_back(static_cast<int>(fan.size()));
  }
  ring_begin.push_back(0);
  std::vector<int> list;
  for (int f = 0; f < m; ++f) {
    list.clear();
    for (int k = 0; k < 3; ++k) {
      const auto& of_vertex = around[static_cast<std::size_t>(t(k, f))];
      list.insert(list.end(), of_vertex.begin(), of_vertex.end());
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (const int other : list)
      if (other != f) ring.push_back(other);
    ring_begin.push_back(static_cast<int>(ring.size()));
  }
  parts = find_parts(triangle_edges, edge_triangles);
}

}  // namespace argil::contact
