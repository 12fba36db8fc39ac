#pragma once

#include <vector>

#include "mesh/tet_mesh.h"
#include "shapes/bcc_lattice.h"

namespace argil::shapes {

/// Tets that fill the inside of a cut lattice, and where their vertices come from.
struct StuffedLattice {
  mesh::TetMesh mesh;
  std::vector<int> node;         ///< per vertex: its lattice node, −1 for a cut
  std::vector<bool> on_surface;  ///< per vertex
};

/// What to keep of the stuffing.
enum class StuffingPart {
  all,
  surface_layer,  ///< only tets with a vertex on the surface
};

/// Fills the inside of `cut_lattice` with the paper's stencils [Labelle2007, fig. 3].
StuffedLattice stuff_lattice(const CutLattice& cut_lattice, StuffingPart part);

/// Faces of one tet whose corners lie on the surface: the body's boundary, normals outward, in order of tets.
Triangles find_surface_faces(const StuffedLattice& stuffed);

}  // namespace argil::shapes
