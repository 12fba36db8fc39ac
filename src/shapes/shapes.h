#pragma once

#include <string>
#include <vector>

#include "mesh/bisection.h"
#include "mesh/tet_mesh.h"
#include "shapes/implicit.h"

namespace argil::shapes {

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

/// How near the number of tets has to come to the one that is asked for.
enum class Count {
  wanted,   ///< within 15 %
  nearest,  ///< as near as the shape allows: where cells are halved afterwards
};

/// Tetrahedral body of a shape with about `target_tets` tets. Box and cylinder have sharp edges.
mesh::TetMesh make_shape_mesh(const Shape& shape, int target_tets, Count count = Count::wanted);

/// The shape's surface, for meshes of it that are halved; none where its faces are flat.
mesh::BoundaryPoint make_boundary_point(const Shape& shape);

/// Triangle skin of a shape with at least `min_triangles` triangles, closed and manifold.
mesh::TriangleMesh make_shape_skin(const Shape& shape, int min_triangles);

}  // namespace argil::shapes
