#pragma once

#include "embed/embedding.h"
#include "mesh/tet_mesh.h"

namespace argil::embed {

/// A skin that its cage carries everywhere, and not by the corners of large triangles alone.
struct FineSkin {
  Triangles triangles;  ///< those of the skin, in its order, each in place of its pieces if it was split
  Embedding embedding;  ///< of its vertices and then of those that were added
};

/// Splits what is larger than the cells beneath. A triangle carried by its corners stays flat between them,
/// so that it is stiffer than a cage of smaller cells, and gives force to the cells under its corners only.
///
/// An edge is halved, for the triangles on both of its sides alike, until it is no longer than
/// `size_over_cell` times the mean edge of the tets at its ends and its middle. Where the middle lies beyond
/// the cage, farther than a quarter of a tet's height, the edge stays as it is. Added vertices lie on the
/// triangles at rest. Where no edge is too long, nothing changes.
/// `skin` and `embedding`: in the tets of `cage`. `size_over_cell` > 0.
FineSkin split_to_cells(const mesh::TriangleMesh& skin, const Embedding& embedding, const mesh::TetMesh& cage,
                        double size_over_cell);

}  // namespace argil::embed
