#include "mesh/quadratic.h"

#include <algorithm>
#include <map>
#include <utility>

namespace argil::mesh {

QuadraticMesh make_quadratic_mesh(const TetMesh& mesh, const Topology& topology) {
  QuadraticMesh out;
  out.tets.resize(10, mesh.num_tets());
  std::map<std::pair<int, int>, int> node_of_edge;
  std::vector<std::pair<int, int>> edges;
  const auto find_node = [&](int a, int b) {
    const std::pair edge = std::minmax(a, b);
    const auto [place, is_new] =
        node_of_edge.try_emplace(edge, mesh.num_vertices() + static_cast<int>(edges.size()));
    if (is_new) edges.emplace_back(edge);
    return place->second;
  };
  for (int t = 0; t < mesh.num_tets(); ++t) {
    out.tets.col(t).head<4>() = mesh.tets.col(t);
    for (int e = 0; e < 6; ++e)
      out.tets(4 + e, t) = find_node(mesh.tets(kTetEdges[e][0], t), mesh.tets(kTetEdges[e][1], t));
  }
  out.boundary.resize(6, topology.boundary.cols());
  for (Eigen::Index f = 0; f < topology.boundary.cols(); ++f) {
    const Eigen::Vector3i face = topology.boundary.col(f);
    out.boundary.col(f) << face(0), face(1), face(2), find_node(face(0), face(1)),
        find_node(face(1), face(2)), find_node(face(2), face(0));
  }
  out.nodes.resize(3, mesh.num_vertices() + static_cast<Eigen::Index>(edges.size()));
  out.nodes.leftCols(mesh.num_vertices()) = mesh.vertices;
  for (std::size_t e = 0; e < edges.size(); ++e)
    out.nodes.col(mesh.num_vertices() + static_cast<Eigen::Index>(e)) =
        0.5 * (mesh.vertices.col(edges[e].first) + mesh.vertices.col(edges[e].second));
  for (const EdgeNode& node : mesh.edge_nodes) out.nodes.col(node_of_edge.at({node.a, node.b})) = node.place;
  return out;
}

Eigen::Matrix<double, 10, 1> compute_quadratic_shape(const Vec4& L) {
  Eigen::Matrix<double, 10, 1> N;
  for (int i = 0; i < 4; ++i) N(i) = L(i) * (2.0 * L(i) - 1.0);
  for (int e = 0; e < 6; ++e) N(4 + e) = 4.0 * L(kTetEdges[e][0]) * L(kTetEdges[e][1]);
  return N;
}

Eigen::Matrix<double, 3, 4> compute_tangent_tet(const QuadraticNodes& nodes, const Vec4& L) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int i = 0; i < 4; ++i) corners.col(i) = (4.0 * L(i) - 1.0) * nodes.col(i);
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = kTetEdges[e];
    corners.col(a) += 4.0 * L(b) * nodes.col(4 + e);
    corners.col(b) += 4.0 * L(a) * nodes.col(4 + e);
  }
  return corners;
}

}  // namespace argil::mesh
