#include "embed/sharp_edges.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace argil::embed {
namespace {

constexpr double kSharp = 0.766;  // cosine of 40 degrees

/// A side of a triangle, from the lower vertex to the higher.
struct Side {
  int a, b, triangle;
};

std::vector<Side> sort_sides(const Triangles& triangles) {
  std::vector<Side> sides;
  for (int t = 0; t < triangles.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangles(k, t), triangles((k + 1) % 3, t));
      sides.push_back({a, b, t});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
    return std::tie(p.a, p.b, p.triangle) < std::tie(q.a, q.b, q.triangle);
  });
  return sides;
}

}  // namespace

SharpEdges find_sharp_edges(const mesh::TriangleMesh& surface) {
  const std::vector<Side> sides = sort_sides(surface.triangles);
  const auto normal = [&](int triangle) {
    return mesh::compute_area_vector(surface.vertices, surface.triangles.col(triangle)).normalized();
  };
  std::vector<std::array<int, 2>> edges;
  std::vector<std::vector<int>> ends(static_cast<std::size_t>(surface.num_vertices()));
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side &p = sides[i - 1], &q = sides[i];
    if (p.a != q.a || p.b != q.b) continue;
    const Vec3 one = normal(p.triangle), other = normal(q.triangle);
    if (one.isZero() || other.isZero() || one.dot(other) > kSharp) continue;
    edges.push_back({p.a, p.b});
    ends[static_cast<std::size_t>(p.a)].push_back(p.b);
    ends[static_cast<std::size_t>(p.b)].push_back(p.a);
  }
  SharpEdges sharp;
  sharp.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i)
    sharp.edges.col(static_cast<Eigen::Index>(i)) << edges[i][0], edges[i][1];
  for (int v = 0; v < surface.num_vertices(); ++v) {
    const std::vector<int>& there = ends[static_cast<std::size_t>(v)];
    const auto way = [&](int end) {
      return Vec3(surface.vertices.col(end) - surface.vertices.col(v)).normalized();
    };
    const bool goes_on = there.size() == 2 && way(there[0]).dot(way(there[1])) < -kSharp;
    if (!there.empty() && !goes_on) sharp.corners.push_back(v);
  }
  return sharp;
}

}  // namespace argil::embed
