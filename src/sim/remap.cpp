#include "sim/remap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/lanes.h"
#include "base/mandel.h"
#include "contact/nearest.h"
#include "embed/tet_locator.h"
#include "mesh/curved.h"
#include "mesh/topology.h"
#include "solid/hencky_lanes.h"

namespace argil::sim {
namespace {

constexpr int kSamples = 8;     // of a tet
constexpr double kHeld = 0.85;  // of a node's place, by weight, that held nodes carry

/// Barycentric coordinates of the places of a tet over which its mean is taken: four points of equal weight
/// [Keast1986, degree 2], and those of the four corners' quarters.
std::array<Vec4, kSamples> list_samples() {
  std::array<Vec4, kSamples> samples;
  for (int k = 0; k < 4; ++k) {
    samples[static_cast<std::size_t>(k)] = Vec4::Constant(0.1381966011250105);
    samples[static_cast<std::size_t>(k)](k) = 0.5854101966249685;
    samples[static_cast<std::size_t>(4 + k)] = Vec4::Constant(0.0625);
    samples[static_cast<std::size_t>(4 + k)](k) = 0.8125;
  }
  return samples;
}

/// Finds tets of a mesh for places of another.
class Places {
 public:
  explicit Places(const mesh::TetMesh& mesh) : m_inside(mesh), m_boundary(mesh) {}
  embed::TetLocator::Place find(const Vec3& x) const {
    embed::TetLocator::Place place = m_inside.find(x);
    if (place.tet < 0) {
      place = m_boundary.find(x, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::infinity());
      place.weights = place.weights.cwiseMax(0.0);
      place.weights /= place.weights.sum();
    }
    return place;
  }

 private:
  embed::TetLocator m_inside;
  embed::BoundaryTets m_boundary;
};

/// For each tet the old tets at its samples.
using Origins = Eigen::Matrix<int, kSamples, Eigen::Dynamic>;

Origins find_origins(const Places& places, const mesh::TetMesh& mesh) {
  const std::array<Vec4, kSamples> samples = list_samples();
  Origins origins(kSamples, mesh.num_tets());
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (int i = 0; i < kSamples; ++i) {
      Vec3 x = Vec3::Zero();
      for (Eigen::Index k = 0; k < 4; ++k)
        x += samples[static_cast<std::size_t>(i)](k) * mesh.vertices.col(mesh.tets(k, t));
      origins(i, t) = places.find(x).tet;
    }
  return origins;
}

/// Mean over the places of each tet.
template <class Columns>
Columns take_means(const Origins& origins, const Columns& from) {
  Columns to(from.rows(), origins.cols());
  for (Eigen::Index t = 0; t < origins.cols(); ++t) {
    to.col(t).setZero();
    for (const int tet : origins.col(t)) to.col(t) += from.col(tet) / kSamples;
  }
  return to;
}
Field take_means(const Origins& origins, const Field& from) {
  const Eigen::RowVectorXd row = from.transpose();
  return take_means(origins, row).transpose();
}

/// The new nodes that are nearest to old ones.
std::vector<int> find_nearest_nodes(const Points& x, const std::vector<int>& old_nodes, const Points& old_x) {
  std::vector<int> nodes;
  for (const int n : old_nodes) nodes.push_back(contact::find_nearest_point(x, old_x.col(n)));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void take_supports(const Body& from, const solid::Body& solid, const Points& x,
                   const std::vector<embed::TetLocator::Place>& of_node, Body& to) {
  to.supports = from.supports;
  for (std::size_t s = 0; s < to.supports.size(); ++s) {
    solid::Region& region = to.supports[s].region;
    region = {};
    region.kind = solid::Region::Kind::nodes;
    const auto is_held = [&](int node) {
      return (solid.model.constraints.support.col(node).array() == static_cast<int>(s)).any();
    };
    std::vector<int> before;
    for (int n = 0; n < from.mesh.num_vertices(); ++n)
      if (is_held(n)) before.push_back(n);
    for (int n = 0; n < to.mesh.num_vertices(); ++n) {
      const embed::TetLocator::Place& place = of_node[static_cast<std::size_t>(n)];
      double held = 0.0;
      for (Eigen::Index k = 0; k < 4; ++k)
        if (is_held(from.mesh.tets(k, place.tet))) held += place.weights(k);
      if (held >= kHeld) region.nodes.push_back(n);
    }
    if (region.nodes.empty()) region.nodes = find_nearest_nodes(to.mesh.vertices, before, x);
  }
}

/// Scales S so that Σ V S, by which the mass goes, is `wanted`: up in tets that are not full, as far as they
/// have room.
void keep_water(const Field& volume, double wanted, Field& saturation) {
  const double whole = volume.dot(saturation);
  if (wanted <= whole) {
    if (whole > 0.0) saturation *= wanted / whole;
    return;
  }
  for (bool has_filled = true; has_filled;) {
    double full = 0.0, open = 0.0;
    for (Eigen::Index t = 0; t < volume.size(); ++t)
      (saturation(t) < 1.0 ? open : full) += volume(t) * saturation(t);
    if (!(open > 0.0)) return;
    const double scale = (wanted - full) / open;
    has_filled = false;
    for (double& S : saturation) {
      if (!(S < 1.0)) continue;
      S = std::min(1.0, scale * S);
      has_filled = has_filled || S == 1.0;
    }
  }
}

}  // namespace

TensorField find_elastic_strain(const solid::Body& solid) {
  const solid::Kinematics& kinematics = solid.kinematics;
  const Eigen::Index num_points = solid.model.elements.num_points();
  TensorField elastic(6, num_points);
  for (Eigen::Index begin = 0; begin < num_points; begin += kLanes) {
    const Eigen::Index end = std::min(begin + kLanes, num_points);
    solid::find_hencky_strain(kinematics.strain().data(), solid.plastic_strain->data(), begin, end,
                              elastic.data());
    for (Eigen::Index p = begin; p < end; ++p) {
      const Vec6 e = elastic.col(p);
      const Mat3 in_frame = (Mat3() << e(0), e(5), e(4), e(5), e(1), e(3), e(4), e(3), e(2)).finished();
      const Mat3 R = kinematics.rotation().middleCols<3>(3 * p);
      elastic.col(p) = to_mandel(R * in_frame * R.transpose());
    }
  }
  return elastic;
}

namespace {

/// At a place of a ten-node tet with these values at its four points: linear between them, and beyond them
/// not past the most and the least of them.
Vec6 interpolate(const TensorField& elastic, const embed::TetLocator::Place& place) {
  Vec4 share = (place.weights.array() - solid::kPointNear) / (solid::kPointFar - solid::kPointNear);
  share = share.cwiseMax(0.0);
  return elastic.middleCols<4>(4 * place.tet) * (share / share.sum());
}

TensorField take_strain(const Places& places, const Origins& origins, const TensorField& from,
                        const mesh::TetMesh& to, bool is_quadratic) {
  if (!is_quadratic) return take_means(origins, from);
  TensorField elastic(6, 4 * to.num_tets());
  for (int t = 0; t < to.num_tets(); ++t)
    for (int k = 0; k < 4; ++k) {
      Vec3 x = Vec3::Zero();
      for (int i = 0; i < 4; ++i)
        x += (i == k ? solid::kPointFar : solid::kPointNear) * to.vertices.col(to.tets(i, t));
      elastic.col(4 * t + k) = interpolate(from, places.find(x));
    }
  return elastic;
}

/// Of each tet, det F_e to the minus one: the mean of its points' logarithms.
Field find_rest_volume_ratio(const TensorField& elastic, Eigen::Index num_tets) {
  const Eigen::Index points = elastic.cols() / num_tets;
  Field ratio(num_tets);
  for (Eigen::Index t = 0; t < num_tets; ++t)
    ratio(t) =
        std::exp(-elastic.middleCols(points * t, points).topRows<3>().sum() / static_cast<double>(points));
  return ratio;
}

/// Of each tet, from its shape at rest to the present one.
TensorField turn_with_clay(const solid::Body& solid, const TensorField& flow) {
  TensorField turned(6, flow.cols());
  for (Eigen::Index t = 0; t < flow.cols(); ++t) {
    const Mat3 R = solid.kinematics.rotation().middleCols<3>(3 * solid.model.elements.points_per_tet * t);
    turned.col(t) = to_mandel(R * from_mandel(flow.col(t)) * R.transpose());
  }
  return turned;
}

Points take_speed(const std::vector<embed::TetLocator::Place>& of_node, const solid::Elements& elements,
                  const Points& v) {
  Points speed(3, static_cast<Eigen::Index>(of_node.size()));
  for (Eigen::Index n = 0; n < speed.cols(); ++n) {
    const embed::TetLocator::Place& place = of_node[static_cast<std::size_t>(n)];
    Eigen::VectorXd weights = place.weights;
    if (elements.nodes_per_tet == 10) weights = mesh::compute_quadratic_shape(place.weights);
    speed.col(n).setZero();
    for (Eigen::Index k = 0; k < weights.size(); ++k)
      speed.col(n) += weights(k) * v.col(elements.nodes(k, place.tet));
  }
  return speed;
}

}  // namespace

RemappedState remap(const Body& from, const solid::Body& solid, const Points& x, const Field& saturation,
                    const TensorField& flow, Body& to) {
  mesh::TetMesh now = from.mesh;
  now.edge_nodes.clear();  // as they were at rest
  now.vertices = x.leftCols(from.mesh.num_vertices());
  const Places places(now);
  const bool is_quadratic = solid.model.elements.nodes_per_tet == 10;
  const Points nodes =
      is_quadratic ? mesh::make_quadratic_mesh(to.mesh, to.topology).nodes : to.mesh.vertices;
  std::vector<embed::TetLocator::Place> of_node;
  for (const Vec3 node : nodes.colwise()) of_node.push_back(places.find(node));
  const Origins origins = find_origins(places, to.mesh);
  to.initial_saturation = take_means(origins, saturation);
  keep_water(mesh::compute_rest_volumes(to.mesh), mesh::compute_rest_volumes(from.mesh).dot(saturation),
             to.initial_saturation);
  if (from.youngs_modulus.size() > 0) to.youngs_modulus = take_means(origins, from.youngs_modulus);
  take_supports(from, solid, x, of_node, to);
  RemappedState state;
  state.elastic = take_strain(places, origins, find_elastic_strain(solid), to.mesh, is_quadratic);
  to.rest_volume_ratio = find_rest_volume_ratio(state.elastic, to.mesh.num_tets());
  state.flow = take_means(origins, turn_with_clay(solid, flow));
  state.v = take_speed(of_node, solid.model.elements, solid.committed.v);
  return state;
}

}  // namespace argil::sim
