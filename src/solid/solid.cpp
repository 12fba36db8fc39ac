#include "solid/solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/ordered_sum.h"
#include "base/parallel.h"

namespace argil::solid {
namespace {

bool contains(const Region& region, const Vec3& x) {
  switch (region.kind) {
    case Region::Kind::box:
      return (x.array() >= region.lower.array()).all() && (x.array() <= region.upper.array()).all();
    case Region::Kind::sphere:
      return (x - region.centre).norm() <= region.radius;
    case Region::Kind::half_space:
      return region.normal.dot(x) <= region.offset;
    case Region::Kind::nodes:
      return false;
  }
  return false;
}

std::vector<std::vector<int>> find_free_neighbours(const Tets& tets, const std::vector<int>& row_of_vertex,
                                                   std::size_t num_rows) {
  std::vector<std::vector<int>> neighbours(num_rows);
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    for (int i = 0; i < 4; ++i) {
      const int row = row_of_vertex[static_cast<std::size_t>(tets(i, t))];
      if (row < 0) continue;
      for (int j = 0; j < 4; ++j) {
        const int column = row_of_vertex[static_cast<std::size_t>(tets(j, t))];
        if (column >= 0) neighbours[static_cast<std::size_t>(row)].push_back(column);
      }
    }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

}  // namespace

std::vector<int> find_vertices(const Points& rest, std::span<const Region> regions) {
  std::vector<int> found;
  for (const Region& region : regions) {
    found.insert(found.end(), region.nodes.begin(), region.nodes.end());
    for (int v = 0; v < rest.cols(); ++v)
      if (contains(region, rest.col(v))) found.push_back(v);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Solid::Solid(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<int> fixed,
             const SolidParams& params, int threads)
    : m_params(params),
      m_threads(threads),
      m_tets(mesh.tets),
      m_vertex_begin(topology.vertex_begin),
      m_vertex_corners(topology.vertex_corners) {
  const Eigen::Index num_tets = mesh.num_tets();
  const Eigen::Index num_vertices = mesh.num_vertices();
  m_volume.resize(num_tets);
  m_gradient.resize(3, 4 * num_tets);
  m_mass.setZero(num_vertices);
  for (Eigen::Index t = 0; t < num_tets; ++t) {
    Mat34 corners;
    for (int i = 0; i < 4; ++i) corners.col(i) = mesh.vertices.col(m_tets(i, t));
    const TetGeometry tet = make_tet_geometry(corners);
    ARGIL_ASSERT(tet.volume > 0.0, t, tet.volume);
    m_volume(t) = tet.volume;
    m_gradient.middleCols<4>(4 * t) = tet.gradient;
    for (int i = 0; i < 4; ++i) m_mass(m_tets(i, t)) += 0.25 * params.density * tet.volume;
  }
  m_material.resize(static_cast<std::size_t>(num_tets));
  m_rotation.resize(3, 3 * num_tets);
  m_strain.setZero(6, num_tets);
  m_volume_ratio.setOnes(num_tets);
  m_turned_gradient.resize(3, 4 * num_tets);
  m_corner_force.setZero(3, 4 * num_tets);
  m_internal_force.setZero(3, num_vertices);

  m_row_of_vertex.assign(static_cast<std::size_t>(num_vertices), 0);
  for (const int v : fixed) m_row_of_vertex[static_cast<std::size_t>(v)] = -1;
  for (int v = 0; v < num_vertices; ++v) {
    int& row = m_row_of_vertex[static_cast<std::size_t>(v)];
    if (row < 0) continue;
    row = static_cast<int>(m_vertex_of_row.size());
    m_vertex_of_row.push_back(v);
  }
  m_matrix = linear::make_block_matrix(find_free_neighbours(m_tets, m_row_of_vertex, m_vertex_of_row.size()));
  m_block_of_corner_pair.resize(static_cast<std::size_t>(16 * num_tets));
  for (int t = 0; t < num_tets; ++t)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const int row = m_row_of_vertex[static_cast<std::size_t>(m_tets(i, t))];
        const int column = m_row_of_vertex[static_cast<std::size_t>(m_tets(j, t))];
        m_block_of_corner_pair[static_cast<std::size_t>(16 * t + 4 * i + j)] =
            row < 0 || column < 0 ? -1 : linear::find_block(m_matrix, row, column);
      }
  m_rhs.setZero(3, num_free());
  m_velocity.setZero(3, num_free());
}

void Solid::set_material(int tet, const TetMaterial& material) {
  m_material[static_cast<std::size_t>(tet)] = material;
}

void Solid::set_anisotropic_stiffness(int tet, const Mat6& C) {
  if (m_stiffness.empty()) {
    m_stiffness.resize(m_material.size());
    for (std::size_t t = 0; t < m_material.size(); ++t)
      m_stiffness[t] = make_isotropic_stiffness(m_material[t].lambda, m_material[t].mu);
  }
  m_stiffness[static_cast<std::size_t>(tet)] = C;
}

StepStatus Solid::update_kinematics(const Points& x, Tick tick) {
  const bool turned = m_params.model == StrainModel::corotational;
  parallel_for(m_tets.cols(), m_threads, [&](std::ptrdiff_t t) {
    Mat34 corners;
    for (int i = 0; i < 4; ++i) corners.col(i) = x.col(m_tets(i, t));
    const Mat34 gradient = m_gradient.middleCols<4>(4 * t);
    const Mat3 F = compute_deformation_gradient(corners, gradient);
    const Mat3 R = turned ? compute_rotation(F) : Mat3(Mat3::Identity());
    m_rotation.middleCols<3>(3 * t) = R;
    m_turned_gradient.middleCols<4>(4 * t) = R * gradient;
    m_strain.col(t) = compute_strain(F, R);
    m_volume_ratio(t) = F.determinant();
  });
  Eigen::Index worst = 0;
  m_min_volume_ratio = m_volume_ratio.minCoeff(&worst);
  const bool finite = m_volume_ratio.allFinite();  // minCoeff may pass over a NaN
  if (finite && m_min_volume_ratio > m_params.min_volume_ratio) return StepStatus::ok();
  if (!finite)
    for (worst = 0; std::isfinite(m_volume_ratio(worst));) ++worst;
  return StepStatus::failed({tick, "solid", static_cast<int>(worst), "volume ratio det F of a tet",
                             m_volume_ratio(worst), m_params.min_volume_ratio});
}

Vec6 Solid::compute_stress(std::size_t tet, const Vec6& elastic_strain) const {
  if (!m_stiffness.empty()) return m_stiffness[tet] * elastic_strain;
  const TetMaterial& material = m_material[tet];
  Vec6 sigma = 2.0 * material.mu * elastic_strain;
  sigma.head<3>().array() += material.lambda * elastic_strain.head<3>().sum();
  return sigma;
}

double Solid::compute_elastic_energy(int tet, const Vec6& plastic_strain) const {
  const Vec6 elastic = m_strain.col(tet) - plastic_strain;
  return 0.5 * m_volume(tet) * elastic.dot(compute_stress(static_cast<std::size_t>(tet), elastic));
}

double Solid::compute_elastic_energy(const SolidState& state) const {
  return ordered_sum(m_tets.cols(), [&](std::ptrdiff_t t) {
    return compute_elastic_energy(static_cast<int>(t), state.plastic_strain.col(t));
  });
}

double Solid::compute_kinetic_energy(const SolidState& state) const {
  return ordered_sum(m_mass.size(),
                     [&](std::ptrdiff_t v) { return 0.5 * m_mass(v) * state.v.col(v).squaredNorm(); });
}

}  // namespace argil::solid
