#pragma once

#include <span>

#include "contact/bounding_tree.h"
#include "contact/surface_features.h"

namespace argil::contact {

/// A triangle surface at one moment of a linear motion.
struct SurfaceAt {
  const SurfaceFeatures& features;
  const Points& x_t0;  ///< [m]
  const Points& x_t1;  ///< [m]
  double t = 1.0;
  Vec3 vertex(int v) const {
    if (t == 1.0) return x_t1.col(v);
    return x_t0.col(v) + t * (x_t1.col(v) - x_t0.col(v));
  }
  Vec3 corner(int face, int k) const { return vertex(features.triangles(k, face)); }
};

/// Number of the point (of 3×n, not none) that is nearest to p; of several the first.
int find_nearest_point(const Points& x, const Vec3& p);

/// Place on a triangle: weights of the corners, exactly 0 where the place lies on an edge or a corner.
struct TrianglePoint {
  Vec3 weight = Vec3::Zero();
  double squared_distance = 0.0;  ///< from the point that was asked for [m²]
};

/// The place of triangle a, b, c nearest to p.
TrianglePoint compute_nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Place on a surface.
struct SurfacePoint {
  int face = -1;
  Vec3 weight = Vec3::Zero();     ///< of the face's corners
  Vec3 point = Vec3::Zero();      ///< [m]
  double squared_distance = 0.0;  ///< from the point that was asked for [m²]
};

/// Place of `face` nearest to p.
SurfacePoint compute_nearest_on_face(const SurfaceAt& surface, int face, const Vec3& p);

/// A face and how far it is from a point.
struct NearFace {
  int face = -1;
  double squared_distance = 0.0;  ///< [m²]
};

/// From `face`, steps to neighbouring faces as long as one is nearer to `p`: the nearest place that the
/// contact can have slid to. Where several faces meet in it, the one that p lies deepest behind; the present
/// face when it is among these. `near`: by number, at least the faces that are nearer to p than `face`.
SurfacePoint walk_to_nearest(const SurfaceAt& surface, const Vec3& p, int face,
                             std::span<const NearFace> near);

/// Of two places: the smaller distance, or, where both are equal, the lower triangle.
bool is_nearer(const SurfacePoint& a, const SurfacePoint& b);

/// The nearest place of all the surface; `face` is a guess that saves work. By is_nearer.
SurfacePoint find_nearest(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int face);

/// Does p lie inside, seen from the nearest place of all the surface? By the normal of the face, the sum of
/// the normals at an edge, or their sum weighted by the angles at a corner: the signs of which are right for
/// every closed surface, also at sharp edges, where a single face's is not [Baerentzen2005].
bool is_behind(const SurfaceAt& surface, const SurfacePoint& nearest, const Vec3& p);

/// Is p inside the surface? `face` as for find_nearest.
bool is_inside(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int face);

/// Distance of p from the surface, negative inside [m]. `face`: as for find_nearest; then the nearest one.
double find_signed_distance(const SurfaceAt& surface, BoundingTree& tree, const Vec3& p, int& face);

/// Outward normal of a face times twice its area [m²].
Vec3 compute_face_normal(const SurfaceAt& surface, int face);

/// Outward direction at an edge: sum of its faces' unit normals.
Vec3 compute_edge_normal(const SurfaceAt& surface, int edge);

/// Is the surface convex at an edge, and does n, across the edge and outward, point away from both of its
/// faces? Only then can the edge be what another surface touches first along n; between flat faces it never
/// is.
bool is_in_normal_cone(const SurfaceAt& surface, int edge, const Vec3& n);

/// Height of p over the plane of a face [m]; negative inside.
double compute_height(const SurfaceAt& surface, int face, const Vec3& p);

}  // namespace argil::contact
