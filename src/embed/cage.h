#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace argil::embed {

struct CageOptions {
  int target_tets = 10000;  ///< wanted number of tets; reached within 15 %
};

struct CageReport {
  int num_tets = 0;
  double cell_size = 0.0;             ///< [m] edge of the background lattice
  double offset = 0.0;                ///< [m] distance from the skin at which most of the boundary lies
  double max_offset = 0.0;            ///< [m] the same at places thinner or sharper than the lattice resolves
  double min_dihedral_degrees = 0.0;  ///< worst of all tets
  double max_dihedral_degrees = 0.0;
  int enclosed_vertices = 0;  ///< all of the surface's, or the cage is not returned
};

struct Cage {
  mesh::TetMesh mesh;
  CageReport report;
};

/// Tetrahedral cage that encloses every vertex of `surface`, which may have holes, non-manifold edges or
/// degenerate faces. Same surface and options, same bits. `name` is used in errors.
Cage make_cage(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name);

}  // namespace argil::embed
