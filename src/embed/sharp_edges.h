#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace argil::embed {

/// Where faces of a surface meet at more than 40 degrees.
struct SharpEdges {
  Eigen::Matrix2Xi edges;    ///< vertices at their ends
  std::vector<int> corners;  ///< vertices where such an edge ends or turns, or several meet
};

SharpEdges find_sharp_edges(const mesh::TriangleMesh& surface);

}  // namespace argil::embed
