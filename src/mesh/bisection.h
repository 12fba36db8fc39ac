#pragma once

#include <array>
#include <functional>
#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Largest size of the cells wanted at a place [m]: the edge of a cube of twelve tets.
using SizeField = std::function<double(const Vec3&)>;

/// Size of a tet of this volume [m³], as a SizeField has it [m].
double compute_cell_size(double volume);

/// A mesh some of whose tets were halved.
struct BisectedMesh {
  TetMesh mesh;             ///< the vertices that were there keep their numbers; fields are the parents'
  std::vector<int> parent;  ///< per tet: the one that it is a part of
  std::vector<std::array<int, 2>>
      halved_edge;  ///< per new vertex: the ends of the edge in whose middle it is, or was
};

/// Where the middle of an edge of the boundary between a and b belongs [m].
using BoundaryPoint = std::function<Vec3(const Vec3& a, const Vec3& b)>;

/// Halves tets at their longest edges until none is larger than wanted at its centroid. All tets around an
/// edge are halved together, and first those of them that have a longer one [Rivara1984]. Edges of one length
/// are taken by number. Tets of a cubic lattice, split round the cubes' centres or body-centred, get parts of
/// three shapes only, with dihedral angles from 45 to 120 degrees. Stops above `most_tets`. New vertices of
/// the boundary go to `boundary_point`, if one is given; where a dihedral angle would fall below 18
/// degrees and below that of flat halves, only a part of the way or none.
BisectedMesh bisect(const TetMesh& mesh, const SizeField& wanted_size, int most_tets,
                    const BoundaryPoint& boundary_point = {});

}  // namespace argil::mesh
