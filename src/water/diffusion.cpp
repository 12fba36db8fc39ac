// Explicit diffusion: two-point flow, its correction and the limiter that keeps the maximum principle.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/check.h"
#include "water/water.h"

namespace argil::water {

int PoreWater::diffuse_in_substeps(double step_s) {
  constexpr double kMostSubsteps = 1e6;  // the scenario refuses long before
  const double wanted = num_substeps(step_s);
  ARGIL_ASSERT(wanted <= kMostSubsteps, wanted, step_s, m_stencil.monotone_step);
  const int substeps = static_cast<int>(wanted);
  for (int substep = 0; substep < substeps; ++substep) diffuse_explicitly(step_s / substeps);
  sort_active();
  return substeps;
}

/// Largest D/D₀ that any water present can have: S rises nowhere above its largest value, or a wall's.
double PoreWater::find_steepest() const {
  const double beta = m_params.diffusivity_exponent;
  if (beta <= 0.0) return 1.0;
  double largest = m_wall.empty() ? 0.0 : m_wall_saturation;
  for (const int t : m_active) largest = std::max(largest, m_state.saturation(t));
  return std::exp(beta * largest);
}

double PoreWater::num_substeps(double step_s) const {
  constexpr double kLimitShare = 0.9;  // so far below the monotone limit that rounding cannot cross it
  double longest = m_stencil.monotone_step;
  for (const WallTet& wall : m_wall) {
    const double through_wall = m_params.diffusivity * wall.area / m_stencil.wall_distance(wall.tet);
    longest = std::min(
        longest, m_stencil.volume(wall.tet) / (m_stencil.conductance.col(wall.tet).sum() + through_wall));
  }
  return std::max(1.0, std::ceil(step_s * find_steepest() / (kLimitShare * longest)));
}

/// Tets that hold water or are next to such.
OrderedItems PoreWater::active_tets() const {
  constexpr std::ptrdiff_t kWorthwhile = 1024;  // tets, for a second thread
  OrderedItems tets(m_threads, kWorthwhile);
  tets.restrict_to(&m_active);
  return tets;
}

void PoreWater::diffuse_explicitly(double step_s) {
  const bool is_corrected = m_params.flux == FluxForm::corrected;
  const OrderedItems tets = active_tets();
  const auto each_active = [&](auto body) {
    tets.each(std::ssize(m_active), [&](std::ptrdiff_t t) { body(static_cast<int>(t)); });
  };
  find_uptake(step_s);
  each_active([&](int t) {
    set_flow(t, step_s);
    if (is_corrected) set_gradient(t);
  });
  for (const WallTet& wall : m_wall) m_change(wall.tet) += wall.uptake / m_stencil.volume(wall.tet);
  if (is_corrected)
    each_active([&](int t) {
      set_correction(t, step_s);
      limit_correction(t);
    });
  each_active([&](int t) {
    if (is_corrected) m_change(t) += compute_let_through(t);
    m_is_newly_wet[static_cast<std::size_t>(t)] = add(t, m_change(t));
  });
  const std::size_t num_active = m_active.size();
  for (std::size_t i = 0; i < num_active; ++i)
    if (m_is_newly_wet[static_cast<std::size_t>(m_active[i])]) activate_around(m_active[i]);
  book_uptake(step_s);
}

bool PoreWater::passes(int a, int b) const {
  if (m_params.scheme == DiffusionScheme::implicit_euler) return b >= 0;
  return b >= 0 && (m_state.saturation(a) > kTrace || m_state.saturation(b) > kTrace);
}

/// Change of S over one substep by the two-point flux. A flow seen from its two sides differs in sign only,
/// bit for bit; so the order of the tets does not matter and nothing is lost between them.
void PoreWater::set_flow(int tet, double step_s) {
  double flow = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    const int other = m_stencil.neighbours(corner, tet);
    if (passes(tet, other))
      flow += m_stencil.conductance(corner, tet) * (m_potential(other) - m_potential(tet));
  }
  m_change(tet) = step_s * flow / m_stencil.volume(tet);
}

void PoreWater::set_gradient(int tet) {
  Vec3 gradient = Vec3::Zero();
  for (int corner = 0; corner < 4; ++corner) {
    const int other = m_stencil.neighbours(corner, tet);
    if (other < 0) continue;
    gradient +=
        (m_potential(other) - m_potential(tet)) * m_stencil.gradient.col(tet).segment<3>(row_of(corner));
  }
  m_gradient.col(tet) = gradient;
}

Vec3 PoreWater::mean_gradient(int tet, int other) const {
  return 0.5 * (m_gradient.col(tet) + m_gradient.col(other));
}

/// The flow that the two-point flux leaves out, from the mean of the two tets' gradients.
void PoreWater::set_correction(int tet, double step_s) {
  for (int corner = 0; corner < 4; ++corner) {
    const int other = m_stencil.neighbours(corner, tet);
    m_correction(corner, tet) =
        passes(tet, other)
            ? step_s * m_stencil.tangent.col(tet).segment<3>(row_of(corner)).dot(mean_gradient(tet, other))
            : 0.0;
  }
}

/// Smallest and largest S among a tet and its neighbours, before and after the two-point step.
std::pair<double, double> PoreWater::find_range(int tet) const {
  const Field& S = m_state.saturation;
  const double low_order = S(tet) + m_change(tet);
  double lowest = std::min(S(tet), low_order), highest = std::max(S(tet), low_order);
  for (int corner = 0; corner < 4; ++corner) {
    const int other = m_stencil.neighbours(corner, tet);
    if (other < 0) continue;
    const double its_low_order = S(other) + m_change(other);
    lowest = std::min({lowest, S(other), its_low_order});
    highest = std::max({highest, S(other), its_low_order});
  }
  return {lowest, highest};
}

/// The share of every correction that keeps each S within that range, whichever of its flows are let through
/// [Zalesak1979].
void PoreWater::limit_correction(int tet) {
  // Rounding of the sums below must not reach over a bound.
  constexpr double kRoundingRoom = 1.0 - 1e-14;
  double raise = 0.0, lower = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    const double flow = m_correction(corner, tet);
    (flow > 0.0 ? raise : lower) += std::abs(flow) / m_stencil.volume(tet);
  }
  const auto share = [](double room, double wish) { return wish > room ? kRoundingRoom * room / wish : 1.0; };
  const double low_order = m_state.saturation(tet) + m_change(tet);
  const auto [lowest, highest] = find_range(tet);
  m_share.col(tet) << share(highest - low_order, raise), share(low_order - lowest, lower);
}

/// Change of S by the corrections that are let through.
double PoreWater::compute_let_through(int tet) const {
  double change = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    const double flow = m_correction(corner, tet);
    if (flow == 0.0) continue;
    const int other = m_stencil.neighbours(corner, tet);
    const double let = flow > 0.0 ? std::min(m_share(0, tet), m_share(1, other))
                                  : std::min(m_share(1, tet), m_share(0, other));
    change += let * flow;
  }
  return change / m_stencil.volume(tet);
}

}  // namespace argil::water
