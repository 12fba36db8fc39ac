#include "contact/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace argil::contact {
namespace {

/// Angle-weighted sum of the normals around a vertex.
Vec3 compute_vertex_normal(const SurfaceAt& surface, int v) {
  const SurfaceFeatures& features = surface.features;
  Vec3 sum = Vec3::Zero();
  for (int i = features.fan_begin[static_cast<std::size_t>(v)];
       i < features.fan_begin[static_cast<std::size_t>(v) + 1]; ++i) {
    const int face = features.fan[static_cast<std::size_t>(i)];
    int k = 0;
    while (features.triangles(k, face) != v) ++k;
    const Vec3 a = surface.corner(face, (k + 1) % 3) - surface.corner(face, k);
    const Vec3 b = surface.corner(face, (k + 2) % 3) - surface.corner(face, k);
    const Vec3 n = a.cross(b);
    sum += std::atan2(n.norm(), a.dot(b)) * n.normalized();
  }
  return sum;
}

/// Among the faces that meet at a place, the one that p lies deepest behind; the present one unless another
/// is deeper by more than rounding, so that a point at rest keeps its face.
int choose_deepest(const SurfaceAt& surface, const SurfacePoint& place, const Vec3& p) {
  const SurfaceFeatures& features = surface.features;
  constexpr double kRounding = 1e-9;
  int best = place.face;
  double height = compute_height(surface, best, p);
  const double margin = kRounding * std::sqrt(place.squared_distance);
  const auto offer = [&](int face) {
    const double other = compute_height(surface, face, p);
    if (!(other < height - margin)) return;
    best = face;
    height = other;
  };
  const int num_zero = static_cast<int>((place.weight.array() == 0.0).count());
  if (num_zero == 1) {
    int zero = 0;
    while (place.weight(zero) != 0.0) ++zero;
    const int edge = features.triangle_edges((zero + 1) % 3, place.face);
    for (int k = 0; k < 2; ++k) offer(features.edge_triangles(k, edge));
  } else if (num_zero == 2) {
    Eigen::Index k = 0;
    place.weight.maxCoeff(&k);
    const auto v = static_cast<std::size_t>(features.triangles(k, place.face));
    for (int i = features.fan_begin[v]; i < features.fan_begin[v + 1]; ++i)
      offer(features.fan[static_cast<std::size_t>(i)]);
  }
  return best;
}

/// The nearest place on the three edges; for triangles without area.
TrianglePoint compute_nearest_on_edges(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  TrianglePoint best;
  best.squared_distance = std::numeric_limits<double>::infinity();
  const std::array<const Vec3*, 3> corner = {&a, &b, &c};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& s = *corner[k];
    const Vec3 edge = *corner[(k + 1) % 3] - s;
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - s).dot(edge) / length, 0.0, 1.0) : 0.0;
    const double d = (p - s - t * edge).squaredNorm();
    if (!(d < best.squared_distance)) continue;
    best.squared_distance = d;
    best.weight.setZero();
    best.weight(static_cast<Eigen::Index>(k)) = 1.0 - t;
    best.weight(static_cast<Eigen::Index>((k + 1) % 3)) = t;
  }
  return best;
}

}  // namespace

Vec3 compute_face_normal(const SurfaceAt& surface, int face) {
  const Vec3 a = surface.corner(face, 0);
  return (surface.corner(face, 1) - a).cross(surface.corner(face, 2) - a);
}

Vec3 compute_edge_normal(const SurfaceAt& surface, int edge) {
  return compute_face_normal(surface, surface.features.edge_triangles(0, edge)).normalized() +
         compute_face_normal(surface, surface.features.edge_triangles(1, edge)).normalized();
}

bool is_in_normal_cone(const SurfaceAt& surface, int edge, const Vec3& n) {
  const Vec3 on_edge = surface.vertex(surface.features.edges(0, edge));
  for (int k = 0; k < 2; ++k)
    if (!(n.dot(surface.vertex(surface.features.edge_opposite(k, edge)) - on_edge) <= 0.0)) return false;
  return n.dot(compute_edge_normal(surface, edge)) > 0.0;
}

double compute_height(const SurfaceAt& surface, int face, const Vec3& p) {
  return compute_face_normal(surface, face).normalized().dot(p - surface.corner(face, 0));
}

int find_nearest_point(const Points& x, const Vec3& p) {
  Eigen::Index nearest = 0;
  (x.colwise() - p).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

TrianglePoint compute_nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const auto at = [&](double wa, double wb, double wc) -> TrianglePoint {
    return {{wa, wb, wc}, (p - a - wb * ab - wc * ac).squaredNorm()};
  };
  // Components of p along ab and ac, seen from each corner. Signs tell the region of p: a corner, an edge, or
  // the face [Ericson2005, §5.1.5].
  const double ab_a = ab.dot(p - a);
  const double ac_a = ac.dot(p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return at(1.0, 0.0, 0.0);
  const double ab_b = ab.dot(p - b);
  const double ac_b = ac.dot(p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return at(0.0, 1.0, 0.0);
  const double ab_c = ab.dot(p - c);
  const double ac_c = ac.dot(p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return at(0.0, 0.0, 1.0);
  // Barycentric coordinates times a common factor.
  const double wc = ab_a * ac_b - ab_b * ac_a;
  if (wc <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0 && ab_a > ab_b) {
    const double t = ab_a / (ab_a - ab_b);
    return at(1.0 - t, t, 0.0);
  }
  const double wb = ab_c * ac_a - ab_a * ac_c;
  if (wb <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0 && ac_a > ac_c) {
    const double t = ac_a / (ac_a - ac_c);
    return at(1.0 - t, 0.0, t);
  }
  const double wa = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b;
  const double from_c = ab_c - ac_c;
  if (wa <= 0.0 && from_b >= 0.0 && from_c >= 0.0 && from_b + from_c > 0.0) {
    const double t = from_b / (from_b + from_c);
    return at(0.0, 1.0 - t, t);
  }
  const double sum = wa + wb + wc;
  if (sum > 0.0) return at(1.0 - wb / sum - wc / sum, wb / sum, wc / sum);
  return compute_nearest_on_edges(p, a, b, c);
}

SurfacePoint compute_nearest_on_face(const SurfaceAt& surface, int face, const Vec3& p) {
  const Vec3 a = surface.corner(face, 0);
  const Vec3 b = surface.corner(face, 1);
  const Vec3 c = surface.corner(face, 2);
  const TrianglePoint found = compute_nearest_on_triangle(p, a, b, c);
  return {face, found.weight, found.weight(0) * a + found.weight(1) * b + found.weight(2) * c,
          found.squared_distance};
}

SurfacePoint walk_to_nearest(const SurfaceAt& surface, const Vec3& p, int face,
                             std::span<const NearFace> near) {
  const SurfaceFeatures& features = surface.features;
  int at = face;
  double least = compute_nearest_on_face(surface, face, p).squared_distance;
  constexpr double kNearer = 1.0 - 1e-12;  // ties by rounding do not move it
  for (bool moved = true; moved;) {
    moved = false;
    const auto ring = features.ring.begin() + features.ring_begin[static_cast<std::size_t>(at)];
    const auto ring_end = features.ring.begin() + features.ring_begin[static_cast<std::size_t>(at) + 1];
    for (const NearFace& other : near) {
      if (!(other.squared_distance < kNearer * least) || !std::binary_search(ring, ring_end, other.face))
        continue;
      at = other.face;
      least = other.squared_distance;
      moved = true;
    }
  }
  const SurfacePoint nearest = compute_nearest_on_face(surface, at, p);
  const int deepest = choose_deepest(surface, nearest, p);
  return deepest == nearest.face ? nearest : compute_nearest_on_face(surface, deepest, p);
}

bool is_nearer(const SurfacePoint& a, const SurfacePoint& b) {
  return a.squared_distance < b.squared_distance ||
         (a.squared_distance == b.squared_distance && a.face < b.face);
}

SurfacePoint find_nearest(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int face) {
  SurfacePoint nearest = compute_nearest_on_face(surface, face, p);
  tree.measure_near(p, nearest.squared_distance, surface.x_t0, surface.x_t1, [&](int candidate) {
    const SurfacePoint found = compute_nearest_on_face(surface, candidate, p);
    if (is_nearer(found, nearest)) nearest = found;
    return found.squared_distance;
  });
  return nearest;
}

bool is_behind(const SurfaceAt& surface, const SurfacePoint& nearest, const Vec3& p) {
  const int num_zero = static_cast<int>((nearest.weight.array() == 0.0).count());
  Vec3 normal;
  if (num_zero == 0) {
    normal = compute_face_normal(surface, nearest.face);
  } else if (num_zero == 1) {
    int zero = 0;
    while (nearest.weight(zero) != 0.0) ++zero;
    normal = compute_edge_normal(surface, surface.features.triangle_edges((zero + 1) % 3, nearest.face));
  } else {
    Eigen::Index k = 0;
    nearest.weight.maxCoeff(&k);
    normal = compute_vertex_normal(surface, surface.features.triangles(k, nearest.face));
  }
  return normal.dot(p - nearest.point) < 0.0;
}

bool is_inside(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int face) {
  return is_behind(surface, find_nearest(surface, tree, p, face), p);
}

double find_signed_distance(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int& face) {
  const SurfacePoint nearest = find_nearest(surface, tree, p, face);
  face = nearest.face;
  const double distance = std::sqrt(nearest.squared_distance);
  return is_behind(surface, nearest, p) ? -distance : distance;
}

}  // namespace argil::contact
