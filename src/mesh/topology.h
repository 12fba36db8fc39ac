#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Who touches whom in a tet mesh; made once. Lists are in increasing order of number.
struct Topology {
  Triangles boundary;             ///< 3×b vertex numbers of the boundary faces, normal outward
  std::vector<int> boundary_tet;  ///< tet that owns each boundary face
  Tets neighbours;                ///< 4×m: tet across the face opposite to corner i, or −1 at the boundary
  std::vector<int> vertex_begin;  ///< n+1: where each vertex's corners begin in vertex_corners
  std::vector<int> vertex_corners;  ///< 4·tet + corner for every tet around a vertex, tets increasing
};

/// Finds faces, neighbours and vertex→tet lists of `mesh`. Vertex numbers must be in range and a face may
/// belong to at most two tets (checked by require_usable; asserted here).
Topology make_topology(const TetMesh& mesh);

/// Volume [m³] of every tet at positions `vertices`.
Field compute_volumes(const Points& vertices, const Tets& tets);

/// Vertices of a triangle surface whose triangles do not form one closed fan, increasing.
std::vector<int> find_non_manifold_vertices(const Triangles& triangles, int num_vertices);

}  // namespace argil::mesh
