#pragma once

#include <span>
#include <vector>

#include "mesh/topology.h"

namespace argil::test {

/// Tet behind each of these boundary faces.
inline std::vector<int> find_tets_behind(const mesh::Topology& topology, std::span<const int> faces) {
  std::vector<int> tets;
  for (const int face : faces) tets.push_back(topology.boundary_tet[static_cast<std::size_t>(face)]);
  return tets;
}

}  // namespace argil::test
