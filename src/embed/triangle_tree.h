#pragma once

#include <vector>

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

  /// How often the surface winds round x: 1 inside and 0 outside a closed surface, a smooth field between
  /// where there are holes. Far groups of triangles count as one dipole [Barill et al. 2018, eq. 14].
  double compute_winding_number(const Vec3& x) const;

 private:
  struct Node {
    Vec3 lower;
    Vec3 upper;
    int first = 0;        // of m_order
    int count = 0;        // triangles below
    int right = -1;       // second child, −1: a leaf; the first child is the next node
    double radius = 0.0;  // largest below
    Vec3 centre;          // area-weighted
    Vec3 area_normal;     // Σ area × normal
    double reach = 0.0;   // largest distance of a corner from the centre
  };
  int build(int first, int count);
  void summarise(Node& node) const;

  mesh::TriangleMesh m_surface;
  Field m_radius;
  std::vector<int> m_order;
  Points m_centroid;  // of each triangle
  std::vector<Node> m_nodes;
};

}  // namespace argil::embed
