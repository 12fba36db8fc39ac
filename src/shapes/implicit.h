#pragma once

#include <functional>

#include "mesh/tet_mesh.h"

namespace argil::shapes {

/// A solid given by a continuous function, negative inside, and a box that contains it.
struct ImplicitSurface {
  std::function<double(const Vec3&)> value;  ///< [m], near the surface close to the signed distance
  Vec3 lower = Vec3::Zero();                 ///< [m]
  Vec3 upper = Vec3::Zero();                 ///< [m]
};

/// Tets of a body-centred cubic lattice cut and snapped to value = 0 (isosurface stuffing, Labelle & Shewchuk
/// 2007): smooth boundary and bounded dihedral angles. `cell_size` [m] is the lattice's cube edge.
mesh::TetMesh stuff_isosurface(const ImplicitSurface& surface, double cell_size);

/// Closed, manifold triangle surface of value = 0, normals outward, from a lattice of `cell_size` [m].
mesh::TriangleMesh extract_isosurface(const ImplicitSurface& surface, double cell_size);

/// The point near x where value = 0, by Newton steps along the gradient; x itself where the function has no
/// usable slope. `length` [m]: the smallest that matters there.
Vec3 project_onto(const ImplicitSurface& surface, Vec3 x, double length);

}  // namespace argil::shapes
