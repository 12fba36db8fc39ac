#pragma once

#include <span>

#include "mesh/box_tree.h"
#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Closest point of one triangle, which may be degenerate.
struct ClosestPoint {
  Vec3 point = Vec3::Zero();
  Vec3 weights = Vec3::Zero();  ///< barycentric weights of the corners
};
ClosestPoint find_closest_point(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

/// Solid angle [steradian] under which triangle a, b, c is seen from x; positive when x looks at its back, so
/// that a closed surface with normals outward sums to 4π inside and 0 outside (Van Oosterom & Strackee 1983).
double compute_solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

/// Boxes in boxes around the triangles of a surface, which need be neither closed nor clean.
class TriangleTree {
 public:
  explicit TriangleTree(const mesh::TriangleMesh& surface);

  /// Thickens the surface: `radius` [m] per vertex, linear between.
  void set_radius(const Field& radius);

  /// Distance from x to the thickened surface [m]: the smallest |x − p| − radius(p) over the triangles'
  /// closest points p; negative within the radius on either side. Returns `limit` where it is larger.
  double compute_distance(const Vec3& x, double limit) const;

  struct Nearest {
    double distance = 0.0;  ///< [m]
    Vec3 point = Vec3::Zero();
    int triangle = -1;
  };
  /// The point of the surface, not thickened, that is nearest to x; `limit` and no point where it is farther.
  Nearest find_nearest(const Vec3& x, double limit) const;

  /// How often the surface winds round x: 1 inside and 0 outside a closed surface, a smooth field between
  /// where there are holes. Far groups of triangles count as one dipole [Barill et al. 2018, eq. 14].
  double compute_winding_number(const Vec3& x) const;

 private:
  /// What is kept of the triangles below a node.
  struct Group {
    double radius = 0.0;              ///< largest
    Vec3 centre = Vec3::Zero();       ///< area-weighted
    Vec3 area_normal = Vec3::Zero();  ///< Σ area × normal
    double reach = 0.0;               ///< largest distance of a corner from the centre
  };
  using Tree = mesh::BoxTree<Group>;

  /// Calls at_triangle(number, closest point) for triangles that may be nearer to x than `smallest`.
  template <class AtTriangle>
  void look_near(const Vec3& x, bool is_thick, const double& smallest, AtTriangle at_triangle) const;
  void summarise(Tree::Node& node, std::span<const int> triangles) const;
  /// Adds to `sum` the solid angle [steradian] of what lies below a node.
  void add_solid_angle(int index, const Vec3& x, double& sum) const;

  mesh::TriangleMesh m_surface;
  Field m_radius;
  Points m_centroid;  // of each triangle
  Tree m_tree;
};

}  // namespace argil::embed
