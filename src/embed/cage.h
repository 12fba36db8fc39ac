#pragma once

#include <string>

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// How a body follows the surface that it is made from.
enum class Fit {
  surface,  ///< its boundary lies on the surface; what is thinner than a cell is thickened
  enclose,  ///< all of the surface's vertices are in it: the paper's cage
};

struct CageOptions {
  int target_tets = 10000;  ///< wanted number of tets; reached within 15 % where a lattice has so many
  Fit fit = Fit::enclose;
  /// Of a fitted body: what is thinner than a cell, and what hangs on it alone, is left out, not thickened.
  bool leaves_thin = false;
  double most_cubes = 1e8;  ///< that the lattice may have in the box of the surface
  /// Of a fitted body: the edges of its boundary are to bend with the surface, so that less is cut off.
  bool bends_edges = false;
};

struct CageReport {
  int num_tets = 0;
  int wanted_tets = 0;     ///< where no lattice has within 15 % of them; else 0
  double cell_size = 0.0;  ///< [m] edge of the background lattice
  double median_distance =
      0.0;  ///< [m] of the boundary from the surface, at corners, middles of edges and centres
  double max_distance = 0.0;  ///< [m] the largest of these
  double max_skin_distance =
      0.0;                    ///< [m] of the surface's vertices from the boundary: what is lost, or covered
  double volume_ratio = 0.0;  ///< body over what the surface encloses; 0 where it is not closed
  double min_dihedral_degrees = 0.0;  ///< worst of all tets
  double max_dihedral_degrees = 0.0;
  int num_vertices = 0;       ///< of the surface
  int enclosed_vertices = 0;  ///< of them
};

/// In words, lengths in millimetres.
std::string describe(const CageReport& report);

struct Cage {
  mesh::TetMesh mesh;
  CageReport report;
};

/// Tetrahedral body of a surface, which may have holes, non-manifold edges or degenerate faces. Fitted to it,
/// its boundary is laid on the surface as far as tets bear that, and its volume is that of a closed one; a
/// surface that winds round nothing is enclosed. Same surface and options, same bits. `name` is used in
/// errors.
Cage make_cage(const mesh::TriangleMesh& surface, const CageOptions& options, const std::string& name);

}  // namespace argil::embed
