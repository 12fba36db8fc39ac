#include "material/moisture.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace argil::material {
namespace {

// Linear interpolation errs by |f''|/8/1024²: 2e-6 of the modulus for every law of this folder (tested).
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

WetState make_state(double E, double nu, double yield) {
  return {E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu)), yield};
}

/// Place of S in the table: lower node and share of the upper one. Rounding may leave S a last bit outside
/// [0, 1].
std::pair<std::size_t, double> locate(double saturation) {
  const double at = std::clamp(saturation, 0.0, 1.0) * kIntervals;
  const auto node = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(kIntervals) - 1);
  return {node, at - static_cast<double>(node)};
}

}  // namespace

MoistureTable::MoistureTable(const Elastic& dry, double yield, const Moisture& moisture, double porosity) {
  const bool anisotropic = moisture.law == MoistureLaw::effective_medium && moisture.softens_elasticity &&
                           !material::is_isotropic(moisture.medium);
  const double nu = dry.poissons_ratio;
  for (int i = 0; i <= kIntervals; ++i) {
    const double S = static_cast<double>(i) / kIntervals;
    WetState state = make_state(dry.youngs_modulus, nu, yield);
    switch (moisture.law) {
      case MoistureLaw::effective_medium: {
        if (!moisture.softens_elasticity) break;
        const MediumResult medium = compute_effective_medium(dry, moisture.medium, porosity * S);
        state.mu = medium.shear_modulus;
        state.lambda = medium.bulk_modulus - 2.0 / 3.0 * medium.shear_modulus;
        if (anisotropic) m_stiffness.push_back(medium.stiffness);
        break;
      }
      case MoistureLaw::liquidity_index: {
        // Strength and modulus fall by the same factor, so the yield strain, their ratio, stays.
        const double ratio = std::pow(moisture.saturated_strength_ratio, S);
        if (moisture.softens_elasticity)
          state = make_state(ratio * dry.youngs_modulus, nu, yield);
        else
          state.yield = ratio * yield;
        break;
      }
      case MoistureLaw::table:
        state =
            make_state(moisture.softens_elasticity
                           ? interpolate_monotone(moisture.table_saturation, moisture.table_youngs_modulus, S)
                           : dry.youngs_modulus,
                       nu, interpolate_monotone(moisture.table_saturation, moisture.table_yield, S));
        break;
    }
    if (moisture.yield_law == YieldLaw::log_linear)
      state.yield *= std::pow(moisture.saturated_yield_ratio, S);
    m_states.push_back(state);
  }
}

WetState MoistureTable::at(double saturation) const {
  const auto [node, share] = locate(saturation);
  const WetState& a = m_states[node];
  const WetState& b = m_states[node + 1];
  return {std::lerp(a.lambda, b.lambda, share), std::lerp(a.mu, b.mu, share),
          std::lerp(a.yield, b.yield, share)};
}

Mat6 MoistureTable::stiffness_at(double saturation) const {
  const auto [node, share] = locate(saturation);
  return (1.0 - share) * m_stiffness[node] + share * m_stiffness[node + 1];
}

bool MoistureTable::is_isotropic() const {
  return m_stiffness.empty();
}

}  // namespace argil::material
