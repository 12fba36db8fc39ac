#include "mesh/curved.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace argil::mesh {
namespace {

constexpr double kLeastShare = 0.3;  // of a Jacobian with straight edges
constexpr double kLeastBend = 1e-6;  // of an edge's length
constexpr double kMostBend = 0.25;   // a quarter of a circle bends by 0.21

using Edge = std::pair<int, int>;

double compute_volume(const Eigen::Matrix<double, 3, 4>& corners) {
  return compute_tet_volume(corners.col(0), corners.col(1), corners.col(2), corners.col(3));
}

/// Barycentric coordinates of a tet's corners, of its edges' nodes and of its points of integration.
std::array<Vec4, 14> list_places() {
  std::array<Vec4, 14> places;
  for (std::size_t i = 0; i < 4; ++i) {
    places[i] = Vec4::Unit(static_cast<Eigen::Index>(i));
    places[10 + i] = Vec4::Constant(kPointNear) + (kPointFar - kPointNear) * places[i];
  }
  for (std::size_t e = 0; e < 6; ++e)
    places[4 + e] = 0.5 * (places[static_cast<std::size_t>(kTetEdges[e][0])] +
                           places[static_cast<std::size_t>(kTetEdges[e][1])]);
  return places;
}

bool bears(const QuadraticNodes& nodes) {
  static const std::array<Vec4, 14> kPlaces = list_places();
  const double straight = compute_volume(nodes.leftCols<4>());
  return std::all_of(kPlaces.begin(), kPlaces.end(), [&](const Vec4& L) {
    return compute_volume(compute_tangent_tet(nodes, L)) >= kLeastShare * straight;
  });
}

std::map<Edge, Vec3> find_places(const BoundaryPoint& boundary_point, const Topology& topology,
                                 const TetMesh& mesh) {
  std::map<Edge, Vec3> places;
  for (const auto& face : topology.boundary.colwise())
    for (int k = 0; k < 3; ++k) {
      const Edge edge = std::minmax(static_cast<int>(face(k)), static_cast<int>(face((k + 1) % 3)));
      if (places.contains(edge)) continue;
      const Vec3 a = mesh.vertices.col(edge.first);
      const Vec3 b = mesh.vertices.col(edge.second);
      const Vec3 place = boundary_point(a, b);
      const double bend = (place - 0.5 * (a + b)).norm() / (b - a).norm();
      if (bend > kLeastBend && bend < kMostBend) places.emplace(edge, place);
    }
  return places;
}

void set_edge_nodes(const std::map<Edge, Vec3>& places, TetMesh& mesh) {
  mesh.edge_nodes.clear();
  for (const auto& [edge, place] : places) mesh.edge_nodes.push_back({edge.first, edge.second, place});
}

/// Points and shares of a rule over a tet [Grundmann1978].
struct Rule {
  std::vector<Vec4> places;
  std::vector<double> shares;  // of the volume; some are below 0
};

/// Exact to degree 5, as Nᵢ times a Jacobian is.
Rule make_rule() {
  constexpr int s = 2, n = 3;
  Rule rule;
  double i_factorial = 1.0;
  for (int i = 0; i <= s; ++i) {
    if (i > 0) i_factorial *= i;
    const int whole = n + 2 * s + 1 - 2 * i;
    double share = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(0.25, s) * std::pow(whole, 2 * s + 1) / i_factorial;
    for (int k = 2; k <= n + 2 * s + 1 - i; ++k) share /= k;
    share *= 6.0;
    for (int a = 0; a <= s - i; ++a)
      for (int b = 0; a + b <= s - i; ++b)
        for (int c = 0; a + b + c <= s - i; ++c) {
          const int d = s - i - a - b - c;
          rule.places.push_back(Vec4(2 * a + 1, 2 * b + 1, 2 * c + 1, 2 * d + 1) / whole);
          rule.shares.push_back(share);
        }
  }
  return rule;
}

}  // namespace

CurvedEdges curve_boundary(const BoundaryPoint& boundary_point, const Topology& topology, TetMesh& mesh) {
  std::map<Edge, Vec3> places = find_places(boundary_point, topology, mesh);
  CurvedEdges out;
  for (bool is_done = false; !is_done;) {
    set_edge_nodes(places, mesh);
    const CurvedTets curved(mesh);
    const std::size_t before = places.size();
    for (int t = 0; t < mesh.num_tets(); ++t) {
      const QuadraticNodes* nodes = curved.find(t);
      if (!nodes || bears(*nodes)) continue;
      for (const auto& [i, j] : kTetEdges) places.erase(std::minmax(mesh.tets(i, t), mesh.tets(j, t)));
    }
    is_done = places.size() == before;
    out.num_straight += static_cast<int>(before - places.size());
  }
  out.num_curved = static_cast<int>(places.size());
  return out;
}

CurvedTets::CurvedTets(const TetMesh& mesh) {
  if (mesh.edge_nodes.empty()) return;
  std::map<Edge, const Vec3*> place_of_edge;
  for (const EdgeNode& node : mesh.edge_nodes) place_of_edge.emplace(Edge(node.a, node.b), &node.place);
  m_place.assign(static_cast<std::size_t>(mesh.num_tets()), -1);
  for (int t = 0; t < mesh.num_tets(); ++t) {
    QuadraticNodes nodes;
    for (int i = 0; i < 4; ++i) nodes.col(i) = mesh.vertices.col(mesh.tets(i, t));
    bool is_curved = false;
    for (int e = 0; e < 6; ++e) {
      const auto [i, j] = kTetEdges[e];
      const auto found = place_of_edge.find(std::minmax(mesh.tets(i, t), mesh.tets(j, t)));
      is_curved = is_curved || found != place_of_edge.end();
      nodes.col(4 + e) =
          found == place_of_edge.end() ? Vec3(0.5 * (nodes.col(i) + nodes.col(j))) : *found->second;
    }
    if (!is_curved) continue;
    m_place[static_cast<std::size_t>(t)] = static_cast<int>(m_nodes.size());
    m_nodes.push_back(nodes);
  }
}

Eigen::Matrix<double, 10, 1> integrate_shape(const QuadraticNodes& nodes) {
  static const Rule kRule = make_rule();
  Eigen::Matrix<double, 10, 1> sum = Eigen::Matrix<double, 10, 1>::Zero();
  for (std::size_t i = 0; i < kRule.places.size(); ++i)
    sum += kRule.shares[i] * compute_volume(compute_tangent_tet(nodes, kRule.places[i])) *
           compute_quadratic_shape(kRule.places[i]);
  return sum;
}

Vec4 find_in_tet(const QuadraticNodes& nodes, const Vec3& x, const Vec4& straight) {
  constexpr int kSteps = 20;
  constexpr double kRounding = 1e-13;  // of a coordinate
  constexpr double kFar = 0.5;
  Vec4 L = straight;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Matrix<double, 3, 4> corners = compute_tangent_tet(nodes, L);
    const Mat3 edges = corners.rightCols<3>().colwise() - corners.col(0);
    const Vec3 way = edges.partialPivLu().solve(x - nodes * compute_quadratic_shape(L));
    L += Vec4(-way.sum(), way(0), way(1), way(2));
    if (!((L - straight).cwiseAbs().maxCoeff() < kFar)) break;
    if (way.cwiseAbs().maxCoeff() < kRounding) return L;
  }
  return straight;
}

Field compute_rest_volumes(const TetMesh& mesh) {
  Field volumes = compute_volumes(mesh.vertices, mesh.tets);
  const CurvedTets curved(mesh);
  for (int t = 0; t < mesh.num_tets(); ++t)
    if (const QuadraticNodes* nodes = curved.find(t)) volumes(t) = integrate_shape(*nodes).sum();
  return volumes;
}

}  // namespace argil::mesh
