#include "water/water.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace argil::water {
namespace {

// The explicit substep stays this far below the monotone limit, so that rounding cannot cross it.
constexpr double kLimitShare = 0.9;

// Two tets that both hold less than this pass nothing. Else an explicit scheme would wet one layer of tets a
// substep with saturations like 1e-100, and a local touch would cost as much as the whole body. What is held
// back is not lost: it stays where it is, and is booked.
constexpr double kTrace = 1e-12;

}  // namespace

void CompensatedSum::add(double x) {
  const double next = sum + x;
  error += std::abs(sum) >= std::abs(x) ? (sum - next) + x : (x - next) + sum;
  sum = next;
}

PoreWater::PoreWater(const mesh::TetMesh& mesh, const mesh::Topology& topology, const WaterParams& params,
                     const Field& initial_saturation)
    : m_params(params),
      m_boundary_tet(topology.boundary_tet),
      m_stencil(make_stencil(mesh, topology, params.diffusivity, params.flux)),
      m_capacity(params.density * params.porosity * m_stencil.volume),
      m_is_active(static_cast<std::size_t>(mesh.num_tets()), 0),
      m_change(Field::Zero(mesh.num_tets())) {
  const Eigen::Index num_tets = mesh.num_tets();
  ARGIL_ASSERT(initial_saturation.size() == num_tets);
  ARGIL_ASSERT((initial_saturation.array() >= 0.0).all() && (initial_saturation.array() <= 1.0).all());
  m_active.reserve(m_is_active.size());
  m_merged.reserve(m_is_active.size());
  m_touched.reserve(m_boundary_tet.size());
  if (params.flux == FluxForm::corrected) {
    m_gradient.setZero(3, num_tets);
    m_correction.setZero(4, num_tets);
    m_share.setZero(2, num_tets);
  }
  m_state.saturation = initial_saturation;
  m_state.carry.setZero(num_tets);
  m_state.collected = initial_saturation;
  activate_all_wet();
  m_state.initial = mass();
}

void PoreWater::restore(const WaterState& state) {
  ARGIL_ASSERT(state.saturation.size() == m_capacity.size(), state.saturation.size());
  m_state = state;
  std::fill(m_is_active.begin(), m_is_active.end(), '\0');
  m_active.clear();
  m_num_sorted = 0;
  activate_all_wet();
}

void PoreWater::activate_all_wet() {
  for (int t = 0; t < static_cast<int>(m_capacity.size()); ++t) {
    if (m_state.saturation(t) > 0.0) activate(t);
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

/// S += change, with the rounding error kept for the next time [Knuth's two-sum].
void PoreWater::add(int tet, double change) {
  const double before = m_state.saturation(tet);
  const double wanted = change + m_state.carry(tet);
  const double after = before + wanted;
  const double kept = after - before;
  m_state.carry(tet) = (before - (after - kept)) + (wanted - kept);
  m_state.saturation(tet) = after;
  if (before <= kTrace && after > kTrace) activate_around(tet);
}

/// Adds `mass` (negative: takes it) as far as the tet can hold or has it, and books what really moved.
void PoreWater::give(int tet, double mass) {
  ARGIL_ASSERT(std::isfinite(mass), tet, mass);
  const double held = m_state.saturation(tet) + m_state.carry(tet);
  const double wanted = held + mass / m_capacity(tet);
  activate(tet);
  if (wanted > 0.0 && wanted < 1.0) {
    add(tet, mass / m_capacity(tet));
    (mass > 0.0 ? m_state.added : m_state.removed).add(std::abs(mass));
    return;
  }
  const double limit = wanted >= 1.0 ? 1.0 : 0.0;
  const double moved = m_capacity(tet) * ((limit - m_state.saturation(tet)) - m_state.carry(tet));
  (moved > 0.0 ? m_state.added : m_state.removed).add(std::abs(moved));
  m_state.saturation(tet) = limit;
  m_state.carry(tet) = 0.0;
  if (limit > kTrace) activate_around(tet);
}

void PoreWater::exchange(std::span<const int> triangle, std::span<const double> area, int sign,
                         double step_s) {
  ARGIL_ASSERT(triangle.size() == area.size() || m_params.uptake == UptakeForm::increment);
  if (m_params.uptake == UptakeForm::flux) {
    const double flux = sign > 0 ? m_params.wetting_flux : -m_params.drying_flux;
    for (std::size_t i = 0; i < triangle.size(); ++i)
      give(m_boundary_tet[static_cast<std::size_t>(triangle[i])], flux * area[i] * step_s);
  } else {
    m_touched.clear();
    for (const int face : triangle) m_touched.push_back(m_boundary_tet[static_cast<std::size_t>(face)]);
    std::sort(m_touched.begin(), m_touched.end());
    m_touched.erase(std::unique(m_touched.begin(), m_touched.end()), m_touched.end());
    for (const int tet : m_touched) give(tet, sign * m_params.saturation_increment * m_capacity(tet));
  }
  sort_active();
}

double PoreWater::num_substeps(double step_s) const {
  return std::max(1.0, std::ceil(step_s / (kLimitShare * m_stencil.monotone_step)));
}

bool PoreWater::passes(int a, int b) const {
  return b >= 0 && (m_state.saturation(a) > kTrace || m_state.saturation(b) > kTrace);
}

/// Change of S in every active tet over one substep by the two-point flux, and its ∇S. A flow seen from its
/// two sides differs in sign only, bit for bit; so the order of the tets does not matter and nothing is lost
/// between them.
void PoreWater::compute_flow(double step_s) {
  const Field& S = m_state.saturation;
  const bool corrected = m_params.flux == FluxForm::corrected;
  for (const int t : m_active) {
    double flow = 0.0;
    Vec3 gradient = Vec3::Zero();
    for (int corner = 0; corner < 4; ++corner) {
      const int other = m_stencil.neighbours(corner, t);
      if (other < 0) continue;
      const double rise = S(other) - S(t);
      if (passes(t, other)) flow += m_stencil.conductance(corner, t) * rise;
      if (corrected) gradient += rise * m_stencil.gradient.col(t).segment<3>(row_of(corner));
    }
    m_change(t) = step_s * flow / m_stencil.volume(t);
    if (corrected) m_gradient.col(t) = gradient;
  }
}

/// The flow that the two-point flux leaves out, from the mean of the two tets' gradients, and the share of it
/// that keeps every S within its neighbours' range before and after the two-point step [Zalesak1979].
void PoreWater::compute_correction(double step_s) {
  const Field& S = m_state.saturation;
  // Rounding of the sums below must not reach over a bound.
  constexpr double kRoundingRoom = 1.0 - 1e-14;
  for (const int t : m_active) {
    const double low_order = S(t) + m_change(t);
    double highest = std::max(S(t), low_order), lowest = std::min(S(t), low_order);
    double raise = 0.0, lower = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      const int other = m_stencil.neighbours(corner, t);
      m_correction(corner, t) = 0.0;
      if (!passes(t, other)) continue;
      const Vec3 mean = 0.5 * (m_gradient.col(t) + m_gradient.col(other));
      const double flow = step_s * m_stencil.tangent.col(t).segment<3>(row_of(corner)).dot(mean);
      m_correction(corner, t) = flow;
      (flow > 0.0 ? raise : lower) += std::abs(flow) / m_stencil.volume(t);
      const double its_low_order = S(other) + m_change(other);
      highest = std::max({highest, S(other), its_low_order});
      lowest = std::min({lowest, S(other), its_low_order});
    }
    const auto share = [](double room, double wish) {
      return wish > room ? kRoundingRoom * room / wish : 1.0;
    };
    m_share.col(t) << share(highest - low_order, raise), share(low_order - lowest, lower);
  }
}

void PoreWater::add_correction(double step_s) {
  compute_correction(step_s);
  for (const int t : m_active) {
    double change = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      const double flow = m_correction(corner, t);
      if (flow == 0.0) continue;
      const int other = m_stencil.neighbours(corner, t);
      const double let = flow > 0.0 ? std::min(m_share(0, t), m_share(1, other))
                                    : std::min(m_share(1, t), m_share(0, other));
      change += let * flow;
    }
    m_change(t) += change / m_stencil.volume(t);
  }
}

int PoreWater::diffuse(double step_s) {
  if (m_active.empty() || !(m_params.diffusivity > 0.0)) return 0;
  constexpr double kMostSubsteps = 1e6;  // the scenario refuses long before
  const double wanted = num_substeps(step_s);
  ARGIL_ASSERT(wanted <= kMostSubsteps, wanted, step_s, m_stencil.monotone_step);
  const int substeps = static_cast<int>(wanted);
  const double h = step_s / substeps;
  for (int substep = 0; substep < substeps; ++substep) {
    compute_flow(h);
    if (m_params.flux == FluxForm::corrected) add_correction(h);
    const std::size_t num_active = m_active.size();
    for (std::size_t i = 0; i < num_active; ++i) add(m_active[i], m_change(m_active[i]));
  }
  sort_active();
  return substeps;
}

void PoreWater::collect_changed(double tolerance, std::vector<int>& tets) {
  tets.clear();
  if (m_state.nothing_collected) {
    for (int t = 0; t < static_cast<int>(m_capacity.size()); ++t) tets.push_back(t);
    m_state.nothing_collected = false;
  } else {
    for (const int t : m_active)
      if (std::abs(m_state.saturation(t) - m_state.collected(t)) > tolerance) tets.push_back(t);
  }
  for (const int t : tets) m_state.collected(t) = m_state.saturation(t);
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
