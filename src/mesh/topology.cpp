#include "mesh/topology.h"

#include <algorithm>
#include <array>

#include "base/check.h"

namespace argil::mesh {
namespace {

// Corners of the face opposite to corner i, counter-clockwise seen from outside a positive tet.
constexpr std::array<std::array<int, 3>, 4> kOppositeFace = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Face {
  std::array<int, 3> key;  // sorted vertex numbers
  int corner;              // 4·tet + opposite corner
};

}  // namespace

Topology make_topology(const TetMesh& mesh) {
  const int num_tets = mesh.num_tets();
  std::vector<Face> faces(static_cast<std::size_t>(4 * num_tets));
  for (int corner = 0; corner < 4 * num_tets; ++corner) {
    const auto tet = mesh.tets.col(corner / 4);
    const auto& local = kOppositeFace[static_cast<std::size_t>(corner % 4)];
    Face& face = faces[static_cast<std::size_t>(corner)];
    face = {{tet(local[0]), tet(local[1]), tet(local[2])}, corner};
    std::sort(face.key.begin(), face.key.end());
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.corner < b.corner;
  });

  Topology topology;
  topology.neighbours.setConstant(4, num_tets, -1);
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].key != faces[i + 1].key) continue;
    const int a = faces[i].corner;
    const int b = faces[i + 1].corner;
    ARGIL_ASSERT(topology.neighbours(a % 4, a / 4) < 0, a / 4, b / 4);
    topology.neighbours(a % 4, a / 4) = b / 4;
    topology.neighbours(b % 4, b / 4) = a / 4;
  }

  std::vector<std::array<int, 3>> boundary;
  for (int corner = 0; corner < 4 * num_tets; ++corner) {
    if (topology.neighbours(corner % 4, corner / 4) >= 0) continue;
    const auto tet = mesh.tets.col(corner / 4);
    const auto& local = kOppositeFace[static_cast<std::size_t>(corner % 4)];
    boundary.push_back({tet(local[0]), tet(local[1]), tet(local[2])});
    topology.boundary_tet.push_back(corner / 4);
  }
  topology.boundary.resize(3, static_cast<Eigen::Index>(boundary.size()));
  for (std::size_t i = 0; i < boundary.size(); ++i)
    topology.boundary.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i(boundary[i].data());

  topology.vertex_begin.assign(static_cast<std::size_t>(mesh.num_vertices()) + 1, 0);
  for (int corner = 0; corner < 4 * num_tets; ++corner)
    ++topology.vertex_begin[static_cast<std::size_t>(mesh.tets(corner % 4, corner / 4)) + 1];
  for (std::size_t v = 1; v < topology.vertex_begin.size(); ++v)
    topology.vertex_begin[v] += topology.vertex_begin[v - 1];
  std::vector<int> next(topology.vertex_begin.begin(), topology.vertex_begin.end() - 1);
  topology.vertex_corners.resize(static_cast<std::size_t>(4 * num_tets));
  for (int corner = 0; corner < 4 * num_tets; ++corner) {
    int& slot = next[static_cast<std::size_t>(mesh.tets(corner % 4, corner / 4))];
    topology.vertex_corners[static_cast<std::size_t>(slot++)] = corner;
  }
  return topology;
}

Field compute_volumes(const Points& vertices, const Tets& tets) {
  Field volumes(tets.cols());
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    volumes(t) = compute_tet_volume(vertices.col(tets(0, t)), vertices.col(tets(1, t)),
                                    vertices.col(tets(2, t)), vertices.col(tets(3, t)));
  return volumes;
}

std::vector<int> find_non_manifold_vertices(const Triangles& triangles, int num_vertices) {
  std::vector<int> begin(static_cast<std::size_t>(num_vertices) + 1, 0);
  for (Eigen::Index i = 0; i < triangles.size(); ++i)
    ++begin[static_cast<std::size_t>(triangles.data()[i]) + 1];
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<std::array<int, 2>> spokes(static_cast<std::size_t>(triangles.size()));  // next and last corner
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int i = 0; i < 3; ++i)
      spokes[static_cast<std::size_t>(next[static_cast<std::size_t>(triangles(i, t))]++)] = {
          triangles((i + 1) % 3, t), triangles((i + 2) % 3, t)};
  std::vector<int> bad;
  for (int v = 0; v < num_vertices; ++v) {
    const auto first = spokes.begin() + begin[static_cast<std::size_t>(v)];
    const auto last = spokes.begin() + begin[static_cast<std::size_t>(v) + 1];
    if (first == last) continue;
    // One closed fan: going from spoke to spoke comes back to the first after every triangle, and no earlier.
    std::sort(first, last);
    bool is_fan = std::adjacent_find(first, last, [](auto& a, auto& b) { return a[0] == b[0]; }) == last;
    std::ptrdiff_t length = 0;
    int spoke = (*first)[0];
    while (is_fan) {
      const auto on = std::lower_bound(first, last, std::array<int, 2>{spoke, -1});
      is_fan = on != last && (*on)[0] == spoke;
      if (!is_fan) break;
      spoke = (*on)[1];
      ++length;
      if (spoke == (*first)[0]) break;
      is_fan = length < last - first;
    }
    if (!is_fan || length != last - first) bad.push_back(v);
  }
  return bad;
}

}  // namespace argil::mesh
