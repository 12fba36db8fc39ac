#include "embed/mesh_parts.h"

#include <algorithm>

#include "mesh/topology.h"

namespace argil::embed {

std::vector<int> label_parts(const mesh::TetMesh& mesh) {
  const mesh::Topology topology = mesh::make_topology(mesh);
  std::vector<int> part(static_cast<std::size_t>(mesh.num_tets()), -1);
  std::vector<int> open;
  int num_parts = 0;
  for (int start = 0; start < mesh.num_tets(); ++start) {
    if (part[static_cast<std::size_t>(start)] >= 0) continue;
    part[static_cast<std::size_t>(start)] = num_parts;
    open.push_back(start);
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (int i = 0; i < 4; ++i) {
        const int n = topology.neighbours(i, t);
        if (n < 0 || part[static_cast<std::size_t>(n)] >= 0) continue;
        part[static_cast<std::size_t>(n)] = num_parts;
        open.push_back(n);
      }
    }
    ++num_parts;
  }
  return part;
}

mesh::TetMesh take_largest_part(const mesh::TetMesh& mesh) {
  const std::vector<int> part = label_parts(mesh);
  std::vector<int> count;
  for (const int p : part) {
    if (p >= static_cast<int>(count.size())) count.resize(static_cast<std::size_t>(p) + 1, 0);
    ++count[static_cast<std::size_t>(p)];
  }
  if (count.size() < 2) return mesh;
  const auto largest = static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<int> number(static_cast<std::size_t>(mesh.num_vertices()), -1);
  mesh::TetMesh taken;
  taken.tets.resize(4, count[static_cast<std::size_t>(largest)]);
  taken.vertices.resize(3, mesh.num_vertices());
  Eigen::Index num_tets = 0;
  Eigen::Index num_vertices = 0;
  for (int t = 0; t < mesh.num_tets(); ++t) {
    if (part[static_cast<std::size_t>(t)] != largest) continue;
    for (Eigen::Index k = 0; k < 4; ++k) {
      const int v = mesh.tets(k, t);
      int& to = number[static_cast<std::size_t>(v)];
      if (to < 0) {
        to = static_cast<int>(num_vertices);
        taken.vertices.col(num_vertices++) = mesh.vertices.col(v);
      }
      taken.tets(k, num_tets) = to;
    }
    ++num_tets;
  }
  taken.vertices.conservativeResize(3, num_vertices);
  return taken;
}

}  // namespace argil::embed
