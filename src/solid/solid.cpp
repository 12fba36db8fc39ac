#include "solid/solid.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "base/check.h"
#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "mesh/order.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

Solid::~Solid() = default;
Solid::Solid(Solid&&) noexcept = default;

Solid::Solid(const mesh::TetMesh& mesh, const mesh::Topology& topology, std::vector<Support> supports,
             const SolidParams& params, int threads)
    : m_params(params),
      m_threads(threads),
      m_elements(make_elements(mesh, topology, params.element)),
      m_supports(std::move(supports)),
      m_constraints(find_constraints(m_elements.rest, m_supports)),
      m_mass(params.density * m_elements.node_volume),
      m_static_mass(params.density * m_elements.shape_volume),
      m_kinematics(m_elements, params.model, threads),
      m_rows(threads),
      m_near_rows(threads),
      m_nodes(threads),
      m_solver(linear::make_solver(
          params.iteration == Iteration::newton ? make_exact(params.solver) : params.solver, threads)) {
  const Eigen::Index num_nodes = m_elements.num_nodes();
  m_material.resize(static_cast<std::size_t>(m_elements.num_tets()));
  m_lambda.setZero(m_elements.num_tets());
  m_mu.setZero(m_elements.num_tets());
  m_excess_bulk.setZero(m_elements.num_tets());
  m_is_tet_changed.resize(m_material.size(), 1);
  const Eigen::Index num_batches = (m_elements.num_tets() + kLanes - 1) / kLanes;
  m_is_batch_new.resize(static_cast<std::size_t>(num_batches), 1);
  m_batch_energy.setZero(num_batches);
  m_batch_plastic_strain.setZero(num_batches);
  m_group_energy.setZero((num_batches + kBatchGroup - 1) / kBatchGroup);
  m_group_plastic_strain.setZero(m_group_energy.size());
  m_corner_force.setZero(3, m_elements.nodes.size() + 1);
  m_internal_force.setZero(3, num_nodes);
  m_product.setZero(3, num_nodes);
  number_rows();
  m_x_hat = m_x = m_held_x = m_x_start = m_elements.rest;
  m_v_hat.setZero(3, num_nodes);
  m_v = m_v_base = m_v_start = m_zero = m_v_hat;
  m_is_row_stale.resize(m_node_of_row.size(), 1);
  m_rows.prepare(num_free());
  m_near_rows.prepare(num_free());
  m_nodes.prepare(num_nodes);
  m_rhs.setZero(3, num_free());
  m_delta.setZero(3, num_free());
  m_left.resize(3, num_free());
  m_correction.resize(3, num_free());
  m_point_sums.reserve(static_cast<std::size_t>((m_elements.num_points() + kLanes - 1) / kLanes));
  if (may_lag_further()) {
    m_direction.resize(3, num_nodes);
    m_change.strain.resize(6, m_elements.num_tets());
    m_change.corner_force.resize(3, m_corner_force.cols());
    if (m_nodal) {
      m_change.volume.resize(m_elements.num_tets());
      m_change.pressure.resize(m_elements.num_tets());
    }
  }
  constexpr int kLarge = 1500;  // rows; with fewer, keeping the lists costs what a smaller solve saves
  if (m_params.extent == Extent::local || (m_params.extent == Extent::automatic && num_free() >= kLarge))
    make_region();
}

/// Must a step be told where this support is? Backward Euler's leaves what does not move where it is.
bool Solid::is_placed(int support) const {
  return m_params.integrator != Integrator::backward_euler ||
         !m_supports[static_cast<std::size_t>(support)].displacement.isZero(0.0);
}

/// Rows of the free nodes and the matrix's pattern.
void Solid::number_rows() {
  m_row_of_node.assign(static_cast<std::size_t>(m_elements.num_nodes()), -1);
  for (int n = 0; n < m_elements.num_nodes(); ++n)
    for (int k = 0; k < 3; ++k)
      if (const int support = m_constraints.support(k, n); support >= 0 && is_placed(support))
        m_placed_components.push_back({n, k});
  m_nodes_along_curve.resize(m_row_of_node.size());
  std::iota(m_nodes_along_curve.begin(), m_nodes_along_curve.end(), 0);
  mesh::sort_along_curve(m_elements.rest, m_nodes_along_curve);
  std::copy_if(m_nodes_along_curve.begin(), m_nodes_along_curve.end(), std::back_inserter(m_node_of_row),
               [this](int n) { return !m_constraints.is_held(n); });
  for (int row = 0; row < num_free(); ++row) {
    const int n = m_node_of_row[static_cast<std::size_t>(row)];
    m_row_of_node[static_cast<std::size_t>(n)] = row;
    if (!m_constraints.is_free(n)) m_held_rows.push_back(row);
  }
  if (m_params.element == ElementKind::p1_nodal)
    m_nodal = std::make_unique<NodalVolume>(m_elements, m_row_of_node, m_threads);
  if (m_nodal && keeps_nodal_factors())
    m_nodal_product =
        std::make_unique<NodalProduct>(*m_nodal, m_node_of_row, m_row_of_node, m_constraints,
                                       m_params.solver.tolerance >= linear::kRoomForFloats, m_threads);
  make_pattern();
}

void Solid::make_pattern() {
  const int N = m_elements.nodes_per_tet;
  const bool only_diagonal = m_params.solver.kind == linear::SolverKind::pcg_matrix_free;
  std::vector<std::vector<int>> rows(m_node_of_row.size());
  if (only_diagonal) {
    for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = {static_cast<int>(row)};
  } else if (m_nodal && !m_nodal_product) {
    rows = m_nodal->find_row_neighbours();
  } else {
    const auto neighbours = find_node_neighbours(m_elements);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (const int node : neighbours[static_cast<std::size_t>(m_node_of_row[row])])
        if (m_row_of_node[static_cast<std::size_t>(node)] >= 0)
          rows[row].push_back(m_row_of_node[static_cast<std::size_t>(node)]);
      std::sort(rows[row].begin(), rows[row].end());
    }
  }
  m_matrix = linear::make_block_matrix(rows);
  if (m_nodal && !m_nodal_product && !only_diagonal) m_nodal->connect(m_matrix);
  m_block_of_corner_pair.clear();
  m_block_of_corner_pair.reserve(static_cast<std::size_t>(N * N) * m_material.size());
  for (int t = 0; t < m_elements.num_tets(); ++t)
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) {
        const int row = m_row_of_node[static_cast<std::size_t>(m_elements.nodes(i, t))];
        const int column = m_row_of_node[static_cast<std::size_t>(m_elements.nodes(j, t))];
        m_block_of_corner_pair.push_back(row < 0 || column < 0 ? -1
                                                               : linear::find_block(m_matrix, row, column));
      }
}

SolidState Solid::make_rest_state() const {
  SolidState state;
  state.x = m_elements.rest;
  state.v.setZero(3, m_elements.num_nodes());
  state.plastic_strain.setZero(6, m_elements.num_points());
  return state;
}

void Solid::set_material(int tet, const TetMaterial& material) {
  if (m_region)
    for (const int node : m_elements.nodes.col(tet)) m_region->wake_node(node);
  m_material[static_cast<std::size_t>(tet)] = material;
  m_is_tet_changed[static_cast<std::size_t>(tet)] = 1;
  m_is_batch_new[static_cast<std::size_t>(tet / kLanes)] = 1;
  if (!m_stiffness.empty())
    m_stiffness[static_cast<std::size_t>(tet)] = make_isotropic_stiffness(material.lambda, material.mu);
  const Elasticity e = elasticity(tet);
  m_lambda(tet) = e.lambda;
  m_mu(tet) = e.mu;
  m_excess_bulk(tet) = e.excess_bulk;
  if (m_nodal) m_nodal->set_excess(tet, e.excess_bulk, m_elements.weight(tet));
}

void Solid::set_anisotropic_stiffness(int tet, const Mat6& C) {
  ARGIL_ASSERT(find_law(m_params.model).takes_full_stiffness && !m_nodal);
  if (m_stiffness.empty()) {
    m_stiffness.resize(m_material.size());
    for (std::size_t t = 0; t < m_material.size(); ++t)
      m_stiffness[t] = make_isotropic_stiffness(m_material[t].lambda, m_material[t].mu);
  }
  m_stiffness[static_cast<std::size_t>(tet)] = C;
  m_is_tet_changed[static_cast<std::size_t>(tet)] = 1;
}

void Solid::set_swelling(int tet, double volume_ratio) {
  ARGIL_ASSERT(volume_ratio > 0.0, tet, volume_ratio);
  if (m_dry.weight.size() == 0) {
    m_dry.gradient = m_elements.gradient;
    m_dry.weight = m_elements.weight;
  }
  const Eigen::Index Q = m_elements.points_per_tet;
  const Eigen::Index columns = Q * m_elements.nodes_per_tet;
  m_elements.gradient.middleCols(columns * tet, columns) =
      m_dry.gradient.middleCols(columns * tet, columns) / std::cbrt(volume_ratio);
  m_kinematics.drop_frame(tet);
  m_is_tet_changed[static_cast<std::size_t>(tet)] = 1;
  m_elements.weight.segment(Q * tet, Q) = volume_ratio * m_dry.weight.segment(Q * tet, Q);
  if (m_nodal) m_nodal->set_excess(tet, elasticity(tet).excess_bulk, m_elements.weight(tet));
}

/// Sums each of the tet's nodes anew, so that masses are a function of the water alone, not of its history.
void Solid::set_water_mass(int tet, double mass) {
  if (m_water_mass.size() == 0) m_water_mass.setZero(m_elements.num_tets());
  m_water_mass(tet) = mass;
  const int N = m_elements.nodes_per_tet;
  for (const int node : m_elements.nodes.col(tet)) {
    double moving = 0.0, at_rest = 0.0;
    for (int c = m_elements.node_begin[static_cast<std::size_t>(node)];
         c < m_elements.node_begin[static_cast<std::size_t>(node) + 1]; ++c) {
      const int corner = m_elements.node_corners[static_cast<std::size_t>(c)];
      moving += m_water_mass(corner / N) * m_elements.mass_share(corner % N);
      at_rest += m_water_mass(corner / N) * m_elements.shape_share(corner % N);
    }
    m_mass(node) = m_params.density * m_elements.node_volume(node) + moving;
    if (const int row = m_row_of_node[static_cast<std::size_t>(node)]; row >= 0)
      m_is_row_stale[static_cast<std::size_t>(row)] = 1;
    m_static_mass(node) = m_params.density * m_elements.shape_volume(node) + at_rest;
  }
}

bool Solid::is_strained(int tet, const TensorField& plastic_strain) const {
  constexpr double kRounding = 1e-12;  // of a strain; a body at rest has some 1e-16
  const Eigen::Index Q = m_elements.points_per_tet;
  for (Eigen::Index p = Q * tet; p < Q * (tet + 1); ++p)
    if (!((m_kinematics.strain().col(p) - plastic_strain.col(p)).norm() <= kRounding)) return true;
  return false;
}

/// Moduli of a tet; for p1_nodal split into its own part and what acts on the nodes' mean volume change.
Elasticity Solid::elasticity(int tet) const {
  const TetMaterial& material = m_material[static_cast<std::size_t>(tet)];
  Elasticity e{material.lambda, material.mu};
  if (!m_stiffness.empty()) e.C = &m_stiffness[static_cast<std::size_t>(tet)];
  if (!m_nodal) return e;
  const double own_bulk = NodalVolume::kOwnBulkOverShear * e.mu;
  e.excess_bulk = std::max(0.0, e.lambda + 2.0 / 3.0 * e.mu - own_bulk);
  e.lambda -= e.excess_bulk;
  if (m_volume_change.size() > 0) e.volume_change = m_volume_change(tet);
  return e;
}

/// How far the frames of the matrix may lag behind R: a step that is solved to a tolerance may as well have a
/// matrix that is off by as much. Its residual is always that of R.
double Solid::frame_tolerance() const {
  constexpr double kLargest = 0.01;
  if (is_newton() || linear::is_direct(m_params.solver.kind)) return 0.0;
  return std::min(kLargest, std::max(m_params.solver.tolerance, m_frame_slack));
}

/// May they lag more than that where a step has slack? Only where what it leaves is known all the same.
bool Solid::may_lag_further() const {
  return has_plain_tets() && frame_tolerance() > 0.0;
}

StepStatus Solid::update_kinematics(const Points& x, Tick tick) {
  return update_motion(x, tick, false);
}

StepStatus Solid::update_motion(const Points& x, Tick tick, bool keeps_frames) {
  const std::vector<int>* batches = m_region && !m_has_old_nodes ? &m_region->batches() : nullptr;
  m_kinematics.update(m_elements, x,
                      {batches, keeps_frames, frame_tolerance(), m_is_tet_changed, m_is_batch_new});
  const double least = m_kinematics.min_volume_ratio();
  // Strain of the linear model has no inside to turn out; in statics its solution is what was asked for.
  const bool may_invert = m_is_static && find_law(m_params.model).is_linear;
  if (std::isfinite(least) && (may_invert || least > m_params.min_volume_ratio)) return StepStatus::ok();
  const int worst = m_kinematics.find_worst_point();
  return StepStatus::failed({tick, "solid", m_elements.number_of_point(worst), "volume ratio det F of a tet",
                             m_kinematics.volume_ratio(worst), m_params.min_volume_ratio});
}

void Solid::compute_volume_changes(const TensorField& plastic_strain, Field& change) const {
  change.resize(m_elements.num_tets());
  const bool is_quadratic = find_law(m_params.model).is_quadratic;  // whose volume change is tr ε_e
  m_rows.each(change.size(), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t t = begin; t < end; ++t)
      change(t) = is_quadratic ? (m_kinematics.strain().col(t) - plastic_strain.col(t)).head<3>().sum()
                               : compute_volume_change(m_params.model, m_kinematics.at(static_cast<int>(t)),
                                                       plastic_strain.col(t));
  });
}

/// p1_nodal: the nodes' mean volume change at the present kinematics.
void Solid::update_volume_change(const TensorField& plastic_strain) {
  if (!m_nodal) return;
  m_nodal->update_stiffness();
  compute_volume_changes(plastic_strain, m_tet_volume_change);
  m_nodal->average(m_tet_volume_change, m_volume_change);
  m_nodal_pressure = m_excess_bulk.cwiseProduct(m_volume_change);
}

Vec6 Solid::compute_flow_drive(int point, const Vec6& plastic_strain, double shape_stiffness) const {
  return solid::compute_flow_drive(m_params.model, m_kinematics.at(point), plastic_strain,
                                   elasticity(m_elements.tet_of_point(point)), shape_stiffness);
}

}  // namespace argil::solid
