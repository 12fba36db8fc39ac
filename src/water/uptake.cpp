// What a tool gives to the clay and takes from it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/check.h"
#include "water/water.h"

namespace argil::water {
namespace {

/// Distance from the wall over which S would fall linearly to the tet's, if the flux were D (1 − S)/distance.
/// `filled`: share of the tet that is as the wall, in [0, 1]; `depth`: of the tet behind the wall, volume
/// over area [m]; `to_wall`: of its centroid [m]. While the water has not reached the tet's back, it is that
/// of a half-space with S = 1 at its wall from some time on: the flux is D/δ with δ = √(πDt), and a depth I =
/// 2√(Dt/π) has been filled, thus δ = π I/2. Then it is the centroid's. Their sum, weighted so that the
/// second counts when the tet is full, is within 1 % of the exact one for a tet with a face on the wall.
/// Where less than a face is touched, it is the centroid's that counts at the latest.
double compute_layer(double filled, double depth, double to_wall) {
  const double free = 1.0 - filled;
  if (!(free > 0.0)) return std::numeric_limits<double>::infinity();
  const double early = 0.5 * std::numbers::pi * filled * depth;
  return std::min(early + to_wall * filled * filled / free, to_wall / free);
}

}  // namespace

/// Moves water through the wall without diffusion: as far as the touched tets hold or have it.
void PoreWater::transfer(const Touch& touch, double step_s) {
  if (m_params.uptake == UptakeForm::flux) {
    const double flux = touch.sign > 0 ? m_params.wetting_flux : -m_params.drying_flux;
    for (std::size_t i = 0; i < touch.tet.size(); ++i) give(touch.tet[i], flux * touch.area[i] * step_s);
  } else {
    m_once.assign(touch.tet.begin(), touch.tet.end());
    std::sort(m_once.begin(), m_once.end());
    m_once.erase(std::unique(m_once.begin(), m_once.end()), m_once.end());
    for (const int t : m_once) give(t, touch.sign * m_params.saturation_increment * m_capacity(t));
  }
  sort_active();
}

/// Adds `mass` (negative: takes it) as far as the tet can hold or has it, and books what really moved.
void PoreWater::give(int tet, double mass) {
  ARGIL_ASSERT(std::isfinite(mass), tet, mass);
  const double held = m_state.saturation(tet) + m_state.carry(tet);
  const double wanted = held + mass / m_capacity(tet);
  activate(tet);
  if (wanted > 0.0 && wanted < 1.0) {
    if (add(tet, mass / m_capacity(tet))) activate_around(tet);
    book(mass);
    return;
  }
  const double limit = wanted >= 1.0 ? 1.0 : 0.0;
  book(m_capacity(tet) * ((limit - m_state.saturation(tet)) - m_state.carry(tet)));
  m_state.saturation(tet) = limit;
  m_state.carry(tet) = 0.0;
  set_potential(tet, limit);
  if (limit > kTrace) activate_around(tet);
}

/// Kilograms that went into the body (negative: out of it).
void PoreWater::book(double mass) {
  (mass > 0.0 ? m_state.added : m_state.removed).add(std::abs(mass));
}

/// From here to the end of move() the touched boundary is not sealed.
void PoreWater::open_wall(const Touch& touch) {
  m_wall_saturation = touch.sign > 0 ? 1.0 : 0.0;
  m_wall_flux = (touch.sign > 0 ? m_params.wetting_flux : m_params.drying_flux) /
                (m_params.density * m_params.porosity);
  if (!(m_wall_flux > 0.0)) return;
  for (std::size_t i = 0; i < touch.tet.size(); ++i) {
    const int t = touch.tet[i];
    ARGIL_ASSERT(std::isfinite(touch.area[i]), t, touch.area[i]);
    if (!(touch.area[i] > 0.0)) continue;
    if (m_wall_area(t) == 0.0) m_wall.push_back({t});
    m_wall_area(t) += touch.area[i];
  }
  std::sort(m_wall.begin(), m_wall.end(), [](const WallTet& a, const WallTet& b) { return a.tet < b.tet; });
  for (WallTet& wall : m_wall) {
    wall.area = std::exchange(m_wall_area(wall.tet), 0.0);
    activate(wall.tet);
  }
  sort_active();
}

/// Mean D between the wall and the tet, over D₀.
double PoreWater::compute_wall_diffusivity(int tet) const {
  const double beta = m_params.diffusivity_exponent;
  const double rise = m_wall_saturation - m_state.saturation(tet);
  if (beta == 0.0 || rise == 0.0) return std::exp(beta * m_wall_saturation);
  return (std::expm1(beta * m_wall_saturation) / beta - m_potential(tet)) / rise;
}

/// Volume of water over n [m³/s] that goes through a wall into its tet, or out of it, over the difference of
/// their S: mean over the coming `step_s`, in which the layer δ becomes √(δ² + πDt).
double PoreWater::compute_wall_conductance(const WallTet& wall, double step_s) const {
  const double D = m_params.diffusivity * compute_wall_diffusivity(wall.tet);
  const double to_wall = m_stencil.wall_distance(wall.tet);
  const double free = std::abs(m_wall_saturation - m_state.saturation(wall.tet));
  if (!(free > 0.0)) return wall.area * D / to_wall;
  const double before = find_free_before(wall.tet);
  const double layer = compute_layer(1.0 - free / before, m_stencil.volume(wall.tet) / wall.area, to_wall);
  const double growth = std::numbers::pi * D * step_s;
  const double flux = 2.0 * D * before / (std::sqrt(layer * layer + growth) + layer);
  return wall.area * std::max(D / to_wall, flux / free);
}

/// How far S was from the wall's before the wall came to the tet: as far as it is in what is least like the
/// wall of its neighbours and theirs.
double PoreWater::find_free_before(int tet) const {
  const auto free = [this](int t) { return std::abs(m_wall_saturation - m_state.saturation(t)); };
  double most = free(tet);
  for (const int next : m_stencil.neighbours.col(tet)) {
    if (next < 0) continue;
    most = std::max(most, free(next));
    for (const int after : m_stencil.neighbours.col(next))
      if (after >= 0) most = std::max(most, free(after));
  }
  return most;
}

/// Of an explicit substep, from the water at its start: what the tool offers and the tet conducts, and no
/// more than the tet has room for whatever its neighbours bring.
void PoreWater::find_uptake(double step_s) {
  const double steepest = find_steepest();
  for (WallTet& wall : m_wall) {
    const double free = m_wall_saturation - m_state.saturation(wall.tet);
    const double passed = step_s * steepest * m_stencil.conductance.col(wall.tet).sum();
    const double conducted = step_s * compute_wall_conductance(wall, step_s);
    const double room = std::max(0.0, m_stencil.volume(wall.tet) - passed);
    const double offered = step_s * m_wall_flux * wall.area;
    wall.uptake = std::copysign(std::min(offered, std::min(conducted, room) * std::abs(free)), free);
  }
}

/// Books the uptake of a (sub)step that the tets now hold.
void PoreWater::book_uptake(double step_s) {
  const double mass_of_volume = m_params.density * m_params.porosity;
  for (const WallTet& wall : m_wall) {
    book(mass_of_volume * wall.uptake);
    // A dry tool leaves no trace: by diffusion alone a tet would become drier for ever.
    if (m_wall_saturation == 0.0 && m_state.saturation(wall.tet) <= kTrace)
      give(wall.tet, -mass_of_volume * m_wall_flux * wall.area * step_s);
  }
}

int PoreWater::move(const Touch& touch, double step_s) {
  m_dried.clear();
  const bool has_wall = m_params.uptake == UptakeForm::flux && m_params.diffusivity > 0.0;
  if (touch.sign != 0 && !touch.tet.empty()) has_wall ? open_wall(touch) : transfer(touch, step_s);
  int solves = 0;
  if (!m_active.empty() && m_params.diffusivity > 0.0)
    solves = m_params.scheme == DiffusionScheme::implicit_euler ? diffuse_implicitly(step_s)
                                                                : diffuse_in_substeps(step_s);
  m_wall.clear();
  if (touch.sign < 0) leave_dry();
  return solves;
}

}  // namespace argil::water
