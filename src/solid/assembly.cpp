// Forces in two passes, each writing one slot an item: tets compute what their corners get, then every node
// gathers its force from the tets around it in the order of their numbers. The matrix is in matrix.cpp.

#include <algorithm>

#include "base/parallel.h"
#include "solid/element.h"
#include "solid/solid.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

template <int N>
void Solid::set_corner_forces() {
  const int Q = m_elements.points_per_tet;
  parallel_for(m_elements.num_tets(), m_threads, [&](std::ptrdiff_t t) {
    const Elasticity e = elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 P =
          m_elements.weight(p) *
          compute_piola(m_params.model, m_kinematics.at(static_cast<int>(p)), m_plastic_strain->col(p), e);
      force.noalias() += P * m_elements.gradient.middleCols<N>(N * p);
    }
    m_corner_force.middleCols<N>(N * t) = force;
  });
}

/// 4-node tets of an isotropic law: those that go eight at a time.
bool Solid::has_isotropic_tets() const {
  return m_elements.nodes_per_tet == 4 && m_stiffness.empty();
}

/// And of a law that is quadratic in the strain: whose forces and energies do.
bool Solid::has_plain_tets() const {
  return has_isotropic_tets() && find_law(m_params.model).is_quadratic;
}

ForceArrays Solid::make_force_arrays(const TensorField& plastic_strain, double* corner_force) const {
  return {m_elements.gradient.data(),
          m_kinematics.rotation().data(),
          m_kinematics.strain().data(),
          plastic_strain.data(),
          m_elements.weight.data(),
          m_lambda.data(),
          m_mu.data(),
          m_nodal ? m_nodal_pressure.data() : nullptr,
          find_law(m_params.model).is_linear,
          corner_force};
}

void Solid::set_tet_forces() {
  const ForceArrays tets = make_force_arrays(*m_plastic_strain, m_corner_force.data());
  const auto set = [&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_corner_forces(tets, begin, end); };
  if (m_has_old_forces)
    for_batches(m_elements.num_tets(), m_threads, set);
  else
    each_batch(set);
}

/// Nodes along the curve: by the thread that has just set the forces around them.
void Solid::gather(const Eigen::Matrix3Xd& corner_force, Points& force) const {
  constexpr std::size_t kAhead = 2;
  const std::vector<int>& nodes = m_nodes.visited() ? *m_nodes.visited() : m_nodes_along_curve;
  const int* corners = m_elements.node_corners.data();
  parallel_for(static_cast<std::ptrdiff_t>(nodes.size()), m_threads, [&](std::ptrdiff_t item) {
    const auto i = static_cast<std::size_t>(item);
    const auto n = static_cast<std::size_t>(nodes[i]);
    const auto next = static_cast<std::size_t>(nodes[std::min(i + kAhead, nodes.size() - 1)]);
    __builtin_prefetch(corners + m_elements.node_begin[next]);
    __builtin_prefetch(corners + m_elements.node_begin[next] + 16);
    sum_corner_forces(corner_force.data(), corners, m_elements.node_begin[n], m_elements.node_begin[n + 1],
                      force.data() + 3 * n);
  });
}

void Solid::assemble_internal_force() {
  update_volume_change(*m_plastic_strain);
  if (has_plain_tets())
    set_tet_forces();
  else if (m_elements.nodes_per_tet == 4)
    set_corner_forces<4>();
  else
    set_corner_forces<10>();
  if (m_region && m_has_old_forces) m_nodes.visit(nullptr);
  gather(m_corner_force, m_internal_force);
  if (m_region && m_has_old_forces) m_nodes.visit(&m_region->nodes());
  m_has_old_forces = false;
}

/// Corner forces of K u, where K takes the kept-rotation stiffness `kept` times and the tangent `exact`
/// times.
template <int N>
void Solid::set_corner_products(const Points& u, double kept, double exact) {
  const int Q = m_elements.points_per_tet;
  const auto displacement_gradient = [&](std::ptrdiff_t p) {
    const int tet = m_elements.tet_of_point(static_cast<int>(p));
    Mat3 H = Mat3::Zero();
    for (int i = 0; i < N; ++i)
      H.noalias() += u.col(m_elements.nodes(i, tet)) * m_elements.gradient.col(N * p + i).transpose();
    return H;
  };
  auto& [change, mean_kept, mean_exact, gradient] = m_of_nodal;  // p1_nodal: the nodes' mean volume change
  const auto average = [&](const auto& gradient_of, Field& mean) {
    change.resize(m_elements.num_tets());
    for (int t = 0; t < m_elements.num_tets(); ++t)
      change(t) = gradient_of(t).cwiseProduct(displacement_gradient(t)).sum();
    m_nodal->average(change, mean);
  };
  if (m_nodal && kept != 0.0) average([&](int t) { return kept_rotation(t); }, mean_kept);
  if (m_nodal && exact != 0.0) average([&](int t) { return volume_gradient(t); }, mean_exact);
  parallel_for(m_elements.num_tets(), m_threads, [&](std::ptrdiff_t t) {
    const Elasticity e = elasticity(static_cast<int>(t));
    Eigen::Matrix<double, 3, N> force = Eigen::Matrix<double, 3, N>::Zero();
    for (int q = 0; q < Q; ++q) {
      const std::ptrdiff_t p = Q * t + q;
      const Mat3 H = displacement_gradient(p);
      Mat3 P = Mat3::Zero();
      if (kept != 0.0) {
        const Mat3 R = kept_rotation(static_cast<int>(p));
        const Mat3 turned = R.transpose() * H;
        Mat3 sigma = from_mandel(compute_stress(e, to_mandel(0.5 * (turned + turned.transpose()))));
        if (m_nodal) sigma.diagonal().array() += e.excess_bulk * mean_kept(t);
        P = kept * R * sigma;
      }
      if (exact != 0.0) {
        const Mat9 A = m_tangent.col(p).reshaped(9, 9);
        P += exact * (A * H.reshaped()).reshaped(3, 3);
        if (m_nodal) P += exact * e.excess_bulk * mean_exact(t) * volume_gradient(static_cast<int>(t));
      }
      force.noalias() += m_elements.weight(p) * P * m_elements.gradient.middleCols<N>(N * p);
    }
    m_corner_force.middleCols<N>(N * t) = force;
  });
}

void Solid::compute_stiffness_product(const Points& u, double kept, double exact, Points& force) {
  if (m_elements.nodes_per_tet == 4)
    set_corner_products<4>(u, kept, exact);
  else
    set_corner_products<10>(u, kept, exact);
  gather(m_corner_force, force);
}

/// K u with the present rotations where those of the stored matrix lag: of nodes that move, for isotropic
/// laws of 4-node tets.
void Solid::compute_present_product(const Points& u, Points& force) {
  const StrainArrays strains{u.data(), m_elements.nodes.data(), m_elements.gradient.data(),
                             m_kinematics.rotation().data(), m_change.strain.data()};
  each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_strains(strains, begin, end); });
  ForceArrays forces = make_force_arrays(m_change.strain, m_change.corner_force.data());
  forces.strain = m_change.strain.data();
  forces.plastic_strain = nullptr;
  if (m_nodal) {
    m_change.volume = m_change.strain.topRows<3>().colwise().sum().transpose();
    m_nodal->average(m_change.volume, m_change.pressure);
    m_change.pressure.array() *= m_excess_bulk.array();
    forces.pressure = m_change.pressure.data();
  }
  each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) { compute_corner_forces(forces, begin, end); });
  gather(m_change.corner_force, force);
}

Mat3 Solid::volume_gradient(int tet) const {
  return compute_volume_gradient(m_params.model, m_kinematics.at(tet), m_plastic_strain->col(tet));
}

/// Frame of the stiffness whose rotation is kept: the present one, or that of the step's start.
Mat3 Solid::kept_rotation(int point) const {
  const Eigen::Matrix3Xd& R = m_kept_rotation.size() > 0 ? m_kept_rotation : m_kinematics.rotation();
  return R.middleCols<3>(3 * static_cast<Eigen::Index>(point));
}

}  // namespace argil::solid
