#pragma once

#include <string>
#include <vector>

#include "mesh/implicit.h"
#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Bodies that argil makes itself.
enum class ShapeKind { sphere, cylinder, box, dinosaur, figure };

struct Shape {
  ShapeKind kind = ShapeKind::sphere;
  double size = 0.1;         ///< [m] sphere: diameter; cylinder: height (diameter = half); box: height;
                             ///< dinosaur: length; figure: height
  double slenderness = 1.0;  ///< box: height over the edge of its square base [–]
};

/// Signed distance-like function of a shape, z up, feet or bottom at z = 0, centred in x and y.
ImplicitSurface make_implicit_shape(const Shape& shape);

/// Tetrahedral body of a shape with about `target_tets` tets. Box and cylinder have sharp edges.
TetMesh make_shape_mesh(const Shape& shape, int target_tets);

/// Flattens a tet in the body, near the top of its axis, to see what a sliver does to a method: a vertex
/// within the body moves towards the opposite face until the height is `share` of what it was, 0 < share < 1.
/// So do its tets whose faces lie in the same plane; the others grow. The body's surface and volume stay.
/// Throws InputError when no vertex can.
void flatten_tet(TetMesh& mesh, double share);

/// Triangle skin of a shape with at least `min_triangles` triangles, closed and manifold.
TriangleMesh make_shape_skin(const Shape& shape, int min_triangles);

}  // namespace argil::mesh
