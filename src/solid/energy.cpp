// Energies of the body.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/ordered_sum.h"
#include "base/parallel.h"
#include "solid/solid.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

double Solid::compute_elastic_energy(int point, const Vec6& plastic_strain) const {
  return m_elements.weight(point) * compute_energy_density(m_params.model, m_kinematics.at(point),
                                                           plastic_strain,
                                                           elasticity(m_elements.tet_of_point(point)));
}

double Solid::compute_elastic_energy(const TensorField& plastic_strain) const {
  if (has_plain_tets() && !m_nodal) {
    const ForceArrays tets = make_force_arrays(plastic_strain, nullptr);
    const std::ptrdiff_t count = m_elements.num_tets();
    return ordered_sum((count + kLanes - 1) / kLanes, [&](std::ptrdiff_t batch) {
      return compute_energy(tets, batch * kLanes, std::min((batch + 1) * kLanes, count));
    });
  }
  const double own = ordered_sum(m_elements.num_points(), [&](std::ptrdiff_t p) {
    return compute_elastic_energy(static_cast<int>(p), plastic_strain.col(p));
  });
  if (!m_nodal) return own;
  m_nodal->update_stiffness();
  compute_volume_changes(plastic_strain, m_of_nodal.change);
  return own + m_nodal->compute_energy(m_of_nodal.change);
}

StrainSummary Solid::summarise(const TensorField& plastic_strain) const {
  const auto find_largest = [&](Eigen::Index begin, Eigen::Index end) {
    double squares = 0.0;
    for (Eigen::Index p = begin; p < end; ++p)
      squares = std::max(squares, plastic_strain.col(p).squaredNorm());
    return std::sqrt(squares);
  };
  if (!has_plain_tets() || m_nodal)
    return {compute_elastic_energy(plastic_strain), find_largest(0, plastic_strain.cols())};
  const ForceArrays tets = make_force_arrays(plastic_strain, nullptr);
  const std::ptrdiff_t num_tets = m_elements.num_tets();
  const auto is_new = [this](std::ptrdiff_t batch) {
    return m_is_batch_new.begin() + std::min<std::ptrdiff_t>(batch, std::ssize(m_is_batch_new));
  };
  parallel_for(m_group_energy.size(), m_threads, [&](std::ptrdiff_t group) {
    const auto begin = is_new(kBatchGroup * group), end = is_new(kBatchGroup * (group + 1));
    if (std::find(begin, end, char{1}) == end) return;
    m_group_energy(group) = m_group_plastic_strain(group) = 0.0;
    for (auto at = begin; at != end; ++at) {
      const std::ptrdiff_t batch = at - m_is_batch_new.begin();
      if (*at != 0) {
        const std::ptrdiff_t first = batch * kLanes;
        const std::ptrdiff_t last = std::min(first + kLanes, num_tets);
        m_batch_energy(batch) = compute_energy(tets, first, last);
        m_batch_plastic_strain(batch) = find_largest(first, last);
        *at = 0;
      }
      m_group_energy(group) += m_batch_energy(batch);
      m_group_plastic_strain(group) = std::max(m_group_plastic_strain(group), m_batch_plastic_strain(batch));
    }
  });
  return {ordered_sum(m_group_energy.size(), [&](std::ptrdiff_t group) { return m_group_energy(group); }),
          m_group_plastic_strain.maxCoeff()};
}

double Solid::compute_kinetic_energy(const SolidState& state) const {
  return m_nodes.sum(m_mass.size(),
                     [&](std::ptrdiff_t v) { return 0.5 * m_mass(v) * state.v.col(v).squaredNorm(); });
}

}  // namespace argil::solid
