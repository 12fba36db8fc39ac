#include "contact/surface_features.h"

#include <algorithm>
#include <array>

namespace argil::contact {

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
}

double compute_squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double nn = n.squaredNorm();
  const double b1 = n.dot((p - a).cross(c - a));
  const double b2 = n.dot((b - a).cross(p - a));
  if (nn > 0.0 && b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= nn) {
    const double d = n.dot(p - a);
    return d * d / nn;
  }
  const auto to_segment = [&p](const Vec3& s, const Vec3& e) {
    const Vec3 edge = e - s;
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - s).dot(edge) / length, 0.0, 1.0) : 0.0;
    return (p - s - t * edge).squaredNorm();
  };
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

int walk_to_nearest(const SurfaceFeatures& features, const Points& x, const Vec3& p, int face) {
  const auto distance = [&](int f) {
    return compute_squared_distance(p, x.col(features.triangles(0, f)), x.col(features.triangles(1, f)),
                                    x.col(features.triangles(2, f)));
  };
  double nearest = distance(face);
  for (bool moved = true; moved;) {
    moved = false;
    const int from = face;
    for (int i = features.ring_begin[static_cast<std::size_t>(from)];
         i < features.ring_begin[static_cast<std::size_t>(from) + 1]; ++i) {
      const int candidate = features.ring[static_cast<std::size_t>(i)];
      const double d = distance(candidate);
      if (!(d < nearest)) continue;
      nearest = d;
      face = candidate;
      moved = true;
    }
  }
  return face;
}

}  // namespace argil::contact
