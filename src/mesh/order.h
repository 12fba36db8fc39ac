#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::mesh {

/// Puts the numbers of points that are near one another in space near one another in the list, and none far
/// from the next: along Hilbert's curve, which goes through all cells of a cube from neighbour to neighbour
/// [Hilbert1891; Skilling2004].
void sort_along_curve(const Points& x, std::vector<int>& list);

/// Puts the tets in the order of their centroids along that curve, with their cell fields, and notes the
/// numbers that they had: programs write tets in any order, and loops that go from one to the next, and from
/// vertices to the tets around them, then find in the cache what they ask for. Vertices stay as they are.
void sort_tets(TetMesh& mesh);

/// Numbers the vertices along that curve. Returns the new number of each.
std::vector<int> sort_vertices(TetMesh& mesh);

/// Entities of tets, a column each, by the numbers that the tets had before they were sorted.
template <class Columns>
Columns in_file_order(const TetMesh& mesh, const Columns& of_tets) {
  Columns sorted(of_tets.rows(), of_tets.cols());
  for (int t = 0; t < mesh.num_tets(); ++t) sorted.col(mesh.number(t)) = of_tets.col(t);
  return sorted;
}
inline Field in_file_order(const TetMesh& mesh, const Field& of_tets) {
  Field sorted(of_tets.size());
  for (int t = 0; t < mesh.num_tets(); ++t) sorted(mesh.number(t)) = of_tets(t);
  return sorted;
}

}  // namespace argil::mesh
