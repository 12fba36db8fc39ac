#include "solid/elements.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "mesh/curved.h"
#include "solid/element.h"

namespace argil::solid {
namespace {

void lay_out_linear(const mesh::TetMesh& mesh, const mesh::Topology& topology, Elements& e) {
  e.rest = mesh.vertices;
  e.nodes = mesh.tets;
  e.surface = topology.boundary;
  e.node_begin = topology.vertex_begin;
  e.node_corners = topology.vertex_corners;
}

void lay_out_quadratic(const mesh::TetMesh& mesh, const mesh::Topology& topology, Elements& e) {
  e.nodes_per_tet = 10;
  e.points_per_tet = 4;
  mesh::QuadraticMesh quadratic = mesh::make_quadratic_mesh(mesh, topology);
  e.rest = std::move(quadratic.nodes);
  e.nodes = quadratic.tets;
  e.surface_per_face = 4;
  e.surface.resize(3, 4 * quadratic.boundary.cols());
  for (Eigen::Index f = 0; f < quadratic.boundary.cols(); ++f) {
    const auto n = quadratic.boundary.col(f);
    e.surface.col(4 * f) << n(0), n(3), n(5);
    e.surface.col(4 * f + 1) << n(3), n(1), n(4);
    e.surface.col(4 * f + 2) << n(5), n(4), n(2);
    e.surface.col(4 * f + 3) << n(3), n(4), n(5);
  }
  std::vector<int> count(static_cast<std::size_t>(e.num_nodes()) + 1, 0);
  for (const int node : e.nodes.reshaped()) ++count[static_cast<std::size_t>(node) + 1];
  for (std::size_t n = 1; n < count.size(); ++n) count[n] += count[n - 1];
  e.node_begin = count;
  e.node_corners.resize(static_cast<std::size_t>(e.nodes.size()));
  for (int t = 0; t < e.num_tets(); ++t)
    for (int k = 0; k < 10; ++k)
      e.node_corners[static_cast<std::size_t>(count[static_cast<std::size_t>(e.nodes(k, t))]++)] = 10 * t + k;
}

/// Returns the volume [m³].
double set_points(const mesh::TetMesh& mesh, Eigen::Index t, Elements& e) {
  const Eigen::Index Q = e.points_per_tet;
  Mat34 corners;
  for (int i = 0; i < 4; ++i) corners.col(i) = mesh.vertices.col(mesh.tets(i, t));
  const TetGeometry tet = make_tet_geometry(corners);
  ARGIL_ASSERT(tet.volume > 0.0, t, tet.volume);
  e.weight.segment(Q * t, Q).setConstant(tet.volume / static_cast<double>(Q));
  for (Eigen::Index p = Q * t; p < Q * (t + 1); ++p) e.gradient.middleCols<4>(4 * p) = tet.gradient;
  return tet.volume;
}

/// The same with bent edges: each point has a gradient and a volume of its own.
double set_bent_points(const mesh::QuadraticNodes& nodes, Eigen::Index t, Elements& e) {
  for (Eigen::Index k = 0; k < 4; ++k) {
    Vec4 L = Vec4::Constant(kPointNear);
    L(k) = kPointFar;
    const TetGeometry tet = make_tet_geometry(mesh::compute_tangent_tet(nodes, L));
    ARGIL_ASSERT(tet.volume > 0.0, t, tet.volume);
    e.weight(4 * t + k) = tet.volume;
    e.gradient.middleCols<4>(4 * (4 * t + k)) = tet.gradient;
  }
  const Eigen::Matrix<double, 10, 1> of_shape = mesh::integrate_shape(nodes);
  const double volume = of_shape.sum();
  e.weight.segment<4>(4 * t) *= volume / e.weight.segment<4>(4 * t).sum();
  e.shape_shares.col(t) = of_shape / volume;
  return volume;
}

void set_straight_shares(Elements& e) {
  Eigen::Matrix<double, 10, 1> share;
  for (int i = 0; i < 10; ++i) share(i) = e.shape_share(0, i);
  e.shape_shares = share.replicate(1, e.num_tets());
}

}  // namespace

template <>
Eigen::Matrix<double, 3, 4> find_node_gradients<4>(const Eigen::Matrix3Xd& gradient, Eigen::Index point) {
  return gradient.middleCols<4>(4 * point);
}

template <>
Eigen::Matrix<double, 3, 10> find_node_gradients<10>(const Eigen::Matrix3Xd& gradient, Eigen::Index point) {
  const Mat34 g = gradient.middleCols<4>(4 * point);
  Vec4 L = Vec4::Constant(kPointNear);
  L(point % 4) = kPointFar;
  Eigen::Matrix<double, 3, 10> of_nodes;
  for (int i = 0; i < 4; ++i) of_nodes.col(i) = (4.0 * L(i) - 1.0) * g.col(i);
  for (int k = 0; k < 6; ++k) {
    const int a = mesh::kTetEdges[k][0];
    const int b = mesh::kTetEdges[k][1];
    of_nodes.col(4 + k) = 4.0 * (L(a) * g.col(b) + L(b) * g.col(a));
  }
  return of_nodes;
}

Elements make_elements(const mesh::TetMesh& mesh, const mesh::Topology& topology, ElementKind kind) {
  Elements e;
  if (kind == ElementKind::p2)
    lay_out_quadratic(mesh, topology, e);
  else
    lay_out_linear(mesh, topology, e);
  e.numbers = mesh.numbers;
  const int N = e.nodes_per_tet;
  e.weight.resize(static_cast<Eigen::Index>(e.points_per_tet) * mesh.num_tets());
  e.gradient.resize(3, 4 * e.weight.size());
  e.node_volume.setZero(e.num_nodes());
  e.shape_volume.setZero(e.num_nodes());
  const mesh::CurvedTets curved(kind == ElementKind::p2 ? mesh : mesh::TetMesh{});
  if (kind == ElementKind::p2 && !mesh.edge_nodes.empty()) set_straight_shares(e);
  for (int t = 0; t < mesh.num_tets(); ++t) {
    const mesh::QuadraticNodes* bent = curved.find(t);
    const double volume = bent ? set_bent_points(*bent, t, e) : set_points(mesh, t, e);
    for (int i = 0; i < N; ++i) {
      e.node_volume(e.nodes(i, t)) += volume * e.mass_share(i);
      e.shape_volume(e.nodes(i, t)) += volume * e.shape_share(t, i);
    }
  }
  return e;
}

std::vector<std::vector<int>> find_node_neighbours(const Elements& e) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(e.num_nodes()));
  for (Eigen::Index t = 0; t < e.nodes.cols(); ++t)
    for (const int a : e.nodes.col(t))
      for (const int b : e.nodes.col(t)) neighbours[static_cast<std::size_t>(a)].push_back(b);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

}  // namespace argil::solid
