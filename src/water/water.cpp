#include "water/water.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "water/implicit_system.h"

namespace argil::water {

void CompensatedSum::add(double x) {
  const double next = sum + x;
  error += std::abs(sum) >= std::abs(x) ? (sum - next) + x : (x - next) + sum;
  sum = next;
}

PoreWater::~PoreWater() = default;
PoreWater::PoreWater(PoreWater&&) noexcept = default;
PoreWater& PoreWater::operator=(PoreWater&&) noexcept = default;

PoreWater::PoreWater(const mesh::TetMesh& mesh, const mesh::Topology& topology, const WaterParams& params,
                     const Field& initial_saturation, int threads)
    : m_params(params),
      m_threads(threads),
      m_stencil(make_stencil(mesh, topology, params.diffusivity, params.flux)),
      m_capacity(params.density * params.porosity * m_stencil.volume),
      m_is_active(static_cast<std::size_t>(mesh.num_tets()), 0),
      m_change(Field::Zero(mesh.num_tets())),
      m_wall_area(Field::Zero(mesh.num_tets())),
      m_is_newly_wet(m_is_active.size(), 0) {
  const Eigen::Index num_tets = mesh.num_tets();
  ARGIL_ASSERT(initial_saturation.size() == num_tets);
  ARGIL_ASSERT((initial_saturation.array() >= 0.0).all() && (initial_saturation.array() <= 1.0).all());
  m_active.reserve(m_is_active.size());
  m_dried.reserve(m_is_active.size());
  m_merged.reserve(m_is_active.size());
  m_once.reserve(m_is_active.size());
  m_wall.reserve(m_is_active.size());
  if (params.flux == FluxForm::corrected) {
    m_gradient.setZero(3, num_tets);
    m_correction.setZero(4, num_tets);
    m_share.setZero(2, num_tets);
  }
  m_state.saturation = initial_saturation;
  m_state.carry.setZero(num_tets);
  m_potential.setZero(num_tets);
  activate_all_wet();
  m_state.initial = mass();
  m_committed = m_state;
}

void PoreWater::restore(const WaterState& state) {
  ARGIL_ASSERT(state.saturation.size() == m_capacity.size(), state.saturation.size());
  m_state = state;
  m_committed = state;
  std::fill(m_is_active.begin(), m_is_active.end(), '\0');
  m_active.clear();
  m_dried.clear();
  m_num_sorted = 0;
  m_potential.setZero();
  activate_all_wet();
}

void PoreWater::activate_all_wet() {
  for (int t = 0; t < static_cast<int>(m_capacity.size()); ++t) {
    if (m_state.saturation(t) > 0.0 || m_state.carry(t) != 0.0) activate(t);
    set_potential(t, m_state.saturation(t));
    if (m_state.saturation(t) > kTrace) activate_around(t);
  }
  sort_active();
}

void PoreWater::activate(int tet) {
  char& active = m_is_active[static_cast<std::size_t>(tet)];
  if (active) return;
  active = 1;
  m_active.push_back(tet);
}

void PoreWater::activate_around(int tet) {
  activate(tet);
  for (int corner = 0; corner < 4; ++corner)
    if (m_stencil.neighbours(corner, tet) >= 0) activate(m_stencil.neighbours(corner, tet));
}

/// Puts the newly active in their place, so that sums over the active do not remember when each became so.
void PoreWater::sort_active() {
  if (m_num_sorted == m_active.size()) return;
  const auto tail = m_active.begin() + static_cast<std::ptrdiff_t>(m_num_sorted);
  std::sort(tail, m_active.end());
  m_merged.resize(m_active.size());
  std::merge(m_active.begin(), tail, tail, m_active.end(), m_merged.begin());
  m_active.swap(m_merged);
  m_num_sorted = m_active.size();
}

/// Leaves the tets that hold nothing and have no wet neighbour any more.
void PoreWater::leave_dry() {
  const auto is_dry = [&](int t) {
    if (m_state.saturation(t) != 0.0 || m_state.carry(t) != 0.0) return false;
    for (int corner = 0; corner < 4; ++corner) {
      const int other = m_stencil.neighbours(corner, t);
      if (other >= 0 && m_state.saturation(other) > kTrace) return false;
    }
    return true;
  };
  m_dried.clear();
  std::erase_if(m_active, [&](int t) {
    const bool leaves = is_dry(t);
    if (leaves) {
      m_dried.push_back(t);
      m_is_active[static_cast<std::size_t>(t)] = 0;
      m_change(t) = 0.0;
    }
    return leaves;
  });
  m_num_sorted = m_active.size();
}

/// u(S) with D(S) = D₀ u'(S) (Kirchhoff): the flow between two tets is that of the mean D between their S.
void PoreWater::set_potential(int tet, double saturation) {
  const double beta = m_params.diffusivity_exponent;
  m_potential(tet) = beta == 0.0 ? saturation : std::expm1(beta * saturation) / beta;
}

/// S += change, with the rounding error kept for the next time [Knuth's two-sum]. True when the tet has now
/// more than a trace and had not.
bool PoreWater::add(int tet, double change) {
  const double before = m_state.saturation(tet);
  const double wanted = change + m_state.carry(tet);
  const double after = before + wanted;
  const double kept = after - before;
  m_state.carry(tet) = (before - (after - kept)) + (wanted - kept);
  // Explicit substeps stay within the bounds; what rounding of an implicit solve puts beyond them is carried.
  const double bounded = std::clamp(after, 0.0, 1.0);
  m_state.carry(tet) += after - bounded;
  m_state.saturation(tet) = bounded;
  set_potential(tet, bounded);
  return before <= kTrace && bounded > kTrace;
}

void PoreWater::commit() {
  const auto keep = [this](int t) {
    m_committed.saturation(t) = m_state.saturation(t);
    m_committed.carry(t) = m_state.carry(t);
  };
  std::for_each(m_active.begin(), m_active.end(), keep);
  std::for_each(m_dried.begin(), m_dried.end(), keep);
  m_committed.added = m_state.added;
  m_committed.removed = m_state.removed;
}

double PoreWater::mass() const {
  CompensatedSum sum;
  for (const int t : m_active) {  // the others hold nothing
    sum.add(m_capacity(t) * m_state.saturation(t));
    sum.add(m_capacity(t) * m_state.carry(t));
  }
  return sum.value();
}

WaterLedger PoreWater::ledger() const {
  return {m_state.initial, m_state.added.value(), m_state.removed.value()};
}

double PoreWater::ledger_error() const {
  return (mass() - m_state.initial - m_state.added.value() + m_state.removed.value()) / m_capacity.sum();
}

}  // namespace argil::water
