#include "material/moisture.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "material/orientation.h"

namespace argil::material {
namespace {

// Linear interpolation errs by |f''|/8/1024²: 2e-6 of the modulus for every scheme (tested).
constexpr int kIntervals = 1024;

/// Monotone cubic through (x, y) at `at`, tangents by harmonic means of the secants [Fritsch & Butland 1984].
double interpolate_monotone(std::span<const double> x, std::span<const double> y, double at) {
  const std::size_t n = x.size();
  const auto secant = [&](std::size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
  const auto tangent = [&](std::size_t i) {
    if (i == 0) return secant(0);
    if (i == n - 1) return secant(n - 2);
    const double a = secant(i - 1);
    const double b = secant(i);
    return a * b <= 0.0 ? 0.0 : 2.0 * a * b / (a + b);  // harmonic mean: never overshoots
  };
  const std::size_t i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      std::upper_bound(x.begin(), x.end(), at) - x.begin() - 1, 0, static_cast<std::ptrdiff_t>(n) - 2));
  const double h = x[i + 1] - x[i];
  const double t = (at - x[i]) / h;
  const double m0 = tangent(i);
  const double m1 = tangent(i + 1);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * y[i] + (t3 - 2 * t2 + t) * h * m0 + (3 * t2 - 2 * t3) * y[i + 1] +
         (t3 - t2) * h * m1;
}

MoistState make_state(double E, double nu, double yield) {
  return {E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu)), yield};
}

MoistState make_state(const MediumResult& medium, double yield) {
  return {medium.bulk_modulus - 2.0 / 3.0 * medium.shear_modulus, medium.shear_modulus, yield};
}

/// Place of S in the table: lower node and share of the upper one. Rounding may leave S a last bit outside
/// [0, 1].
std::pair<std::size_t, double> locate(double saturation) {
  const double at = std::clamp(saturation, 0.0, 1.0) * kIntervals;
  const auto node = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kIntervals) - 1);
  return {node, at - static_cast<double>(node)};
}

MoistState interpolate_state(const std::vector<MoistState>& states, double saturation) {
  const auto [node, share] = locate(saturation);
  const MoistState& a = states[node];
  const MoistState& b = states[node + 1];
  return {std::lerp(a.lambda, b.lambda, share), std::lerp(a.mu, b.mu, share), a.yield};
}

}  // namespace

bool is_isotropic(const Moisture& moisture) {
  return moisture.law != MoistureLaw::effective_medium || !moisture.softens_elasticity ||
         is_isotropic(moisture.medium);
}

double compute_liquidity_factor(const Moisture& m, double saturation) {
  const double index =
      (saturation - m.plastic_limit_saturation) / (m.liquid_limit_saturation - m.plastic_limit_saturation);
  return std::pow(m.saturated_strength_ratio, std::max(0.0, index));
}

double compute_suction_factor(const Moisture& m, double saturation) {
  if (m.suction_peak_ratio == 1.0) return 1.0;
  const double S = std::clamp(saturation, 0.0, 1.0);
  const double peak = m.suction_peak_saturation;
  const double falling = std::pow((1.0 - S) / (1.0 - peak), (1.0 - peak) / peak);
  return 1.0 + (m.suction_peak_ratio - 1.0) * (S / peak) * falling;
}

MoistureTable::MoistureTable(const Elastic& dry, double yield, const Moisture& moisture, double porosity)
    : m_dry(dry), m_yield(yield), m_porosity(porosity), m_moisture(moisture) {
  if (moisture.law != MoistureLaw::effective_medium || !moisture.softens_elasticity) return;
  const bool anisotropic = !material::is_isotropic(moisture.medium);
  for (int i = 0; i <= kIntervals; ++i) {
    const MediumResult medium = evaluate(static_cast<double>(i) / kIntervals, dry.youngs_modulus);
    m_states.push_back(make_state(medium, yield));
    if (anisotropic) m_stiffness.push_back(medium.stiffness);
  }
}

MediumResult MoistureTable::evaluate(double saturation, double youngs_modulus) const {
  const double S = std::clamp(saturation, 0.0, 1.0);  // rounding may leave it a last bit outside
  return compute_effective_medium({youngs_modulus, m_dry.poissons_ratio}, m_moisture.medium, m_porosity * S);
}

/// Do all moduli grow with the dry one? Those of clay with stiff water do not.
bool MoistureTable::is_proportional() const {
  const EffectiveMedium& medium = m_moisture.medium;
  return m_states.empty() || (medium.fluid_bulk_modulus == 0.0 && medium.fluid_shear_modulus == 0.0);
}

MoistState MoistureTable::at(double saturation) const {
  const double S = std::clamp(saturation, 0.0, 1.0);
  const Moisture& m = m_moisture;
  if (!m_states.empty()) return with_strength(interpolate_state(m_states, S), S);
  if (m.law != MoistureLaw::table)
    return with_strength(make_state(m_dry.youngs_modulus, m_dry.poissons_ratio, m_yield), S);
  const double E = m.softens_elasticity ? interpolate_monotone(m.table_saturation, m.table_youngs_modulus, S)
                                        : m_dry.youngs_modulus;
  const double yield = interpolate_monotone(m.table_saturation, m.table_yield, S);
  return with_strength(make_state(E, m_dry.poissons_ratio, yield), S);
}

MoistState MoistureTable::at(double saturation, double youngs_modulus) const {
  if (!is_proportional())
    return with_strength(make_state(evaluate(saturation, youngs_modulus), m_yield), saturation);
  const Moisture& m = m_moisture;
  const bool by_table = m.law == MoistureLaw::table && m.softens_elasticity;
  const double factor = youngs_modulus / (by_table ? m.table_youngs_modulus.front() : m_dry.youngs_modulus);
  MoistState state = at(saturation);
  state.lambda *= factor;
  state.mu *= factor;
  return state;
}

/// What suction, liquidity and yield law make of modulus and yield strain.
MoistState MoistureTable::with_strength(MoistState state, double saturation) const {
  const Moisture& m = m_moisture;
  double strength = compute_suction_factor(m, saturation);  // of modulus and yield stress alike
  if (m.law == MoistureLaw::liquidity_index) strength *= compute_liquidity_factor(m, saturation);
  if (m.softens_elasticity) {
    state.lambda *= strength;
    state.mu *= strength;
  } else {
    state.yield *= strength;
  }
  if (m.yield_law == YieldLaw::log_linear) state.yield *= std::pow(m.saturated_yield_ratio, saturation);
  return state;
}

Mat6 MoistureTable::stiffness_at(double saturation, const Vec3& axis) const {
  const auto [node, share] = locate(saturation);
  const Mat6 C = (1.0 - share) * m_stiffness[node] + share * m_stiffness[node + 1];
  return compute_suction_factor(m_moisture, saturation) * lay_along(C, axis);
}

Mat6 MoistureTable::stiffness_at(double saturation, const Vec3& axis, double youngs_modulus) const {
  if (is_proportional()) return youngs_modulus / m_dry.youngs_modulus * stiffness_at(saturation, axis);
  return compute_suction_factor(m_moisture, saturation) *
         lay_along(evaluate(saturation, youngs_modulus).stiffness, axis);
}

bool MoistureTable::is_isotropic() const {
  return m_stiffness.empty();
}

}  // namespace argil::material
