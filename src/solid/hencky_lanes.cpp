#include "solid/hencky_lanes.h"

#include "base/mandel.h"
#include "solid/hencky_point.h"
#include "solid/pair_blocks.h"

namespace argil::solid {
namespace {

/// E_p of tets; false where none has any.
ARGIL_INLINE bool read_plastic(const double* from, std::ptrdiff_t begin, std::ptrdiff_t last,
                               Lanes* plastic) {
  if (!from) return false;
  read_tensor(from, begin, last, plastic);
  Lanes size = {};
  for (int k = 0; k < 6; ++k) size += plastic[k] * plastic[k];
  return any(size);
}

/// Elastic strain ½ ln b of tets, which is found where it is not known.
ARGIL_INLINE void read_elastic(const double* strain, const double* plastic_strain, const ElasticArrays& found,
                               std::ptrdiff_t begin, std::ptrdiff_t end, Lanes* elastic) {
  const std::ptrdiff_t last = end - 1;
  char* is_known = found.is_known ? found.is_known + begin / kLanes : nullptr;
  if (is_known && *is_known) return read_lanes<6>(found.strain, begin, last, elastic);
  Lanes whole[6], plastic[6];
  read_tensor(strain, begin, last, whole);
  const bool is_plastic = read_plastic(plastic_strain, begin, last, plastic);
  find_elastic_strain(whole, is_plastic ? plastic : nullptr, elastic);
  if (!is_known) return;
  write_lanes<6>(elastic, begin, end, found.strain);
  *is_known = 1;
}

}  // namespace

ARGIL_EVERY_PROCESSOR void compute_hencky_forces(const ForceArrays& tets, std::ptrdiff_t begin,
                                                 std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], lambda, mu, weight, gradient[12];
  Real33<Lanes> R;
  read_tensor(tets.strain, begin, last, strain);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  read_lanes<9>(tets.R, begin, last, R.m);
  read_lanes<12>(tets.gradient, begin, last, gradient);
  Lanes elastic[6], pressure = {};
  read_elastic(tets.strain, tets.plastic_strain, tets.elastic, begin, end, elastic);

  // V R τ S⁻¹ ∇Nᵢ.
  if (tets.pressure) read_lanes<1>(tets.pressure, begin, last, &pressure);
  pressure = weight * (lambda * (elastic[0] + elastic[1] + elastic[2]) + pressure);
  Lanes stress[6];
  for (int k = 0; k < 6; ++k) stress[k] = weight * (2.0 * mu) * elastic[k];
  for (int k = 0; k < 3; ++k) stress[k] += pressure;
  Real33<Lanes> tau, inverse, P, piola;
  set_symmetric(stress, tau);
  set_inverse(strain, inverse);
  multiply(tau, inverse, P);
  multiply(R, P, piola);
  Lanes force[12];
  turn(piola, gradient, force);
  write_lanes<12>(force, begin, end, tets.corner_force);
}

ARGIL_EVERY_PROCESSOR double compute_hencky_energy(const ForceArrays& tets, std::ptrdiff_t begin,
                                                   std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes lambda, mu, weight;
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  Lanes elastic[6];
  read_elastic(tets.strain, tets.plastic_strain, tets.elastic, begin, end, elastic);
  Lanes squares = {};
  for (int k = 0; k < 3; ++k) squares += elastic[k] * elastic[k] + 2.0 * (elastic[k + 3] * elastic[k + 3]);
  const Lanes trace = elastic[0] + elastic[1] + elastic[2];
  const Lanes energy = weight * (mu * squares + 0.5 * lambda * trace * trace);
  double sum = 0.0;
  for (std::ptrdiff_t t = begin; t < end; ++t) sum += energy[t - begin];
  return sum;
}

ARGIL_EVERY_PROCESSOR void find_hencky_strain(const double* strain, const double* plastic_strain,
                                              std::ptrdiff_t begin, std::ptrdiff_t end, double* elastic) {
  Lanes found[6];
  read_elastic(strain, plastic_strain, {}, begin, end, found);
  write_lanes<6>(found, begin, end, elastic);
}

ARGIL_EVERY_PROCESSOR unsigned flow_by_hencky(const FlowArrays& points, std::ptrdiff_t begin,
                                              std::ptrdiff_t end, double* dissipated) {
  // Stretches of F_p are e^±8 then, whose squares are as far apart as numbers have digits. Clay is elastic
  // beyond.
  constexpr double kMostPlastic = 8.0;
  const std::ptrdiff_t last = end - 1;
  const Lanes zero = {};
  const Lanes one = zero + 1.0;
  Lanes elastic[6], deviator[6], yield, norm;
  read_lanes<1>(points.yield, begin, last, &yield);
  read_elastic(points.strain, points.plastic_strain, points.elastic, begin, end, elastic);
  const Lanes mean = (elastic[0] + elastic[1] + elastic[2]) / 3.0;
  Lanes squares = {};
  for (int k = 0; k < 6; ++k) deviator[k] = k < 3 ? elastic[k] - mean : elastic[k];
  for (int k = 0; k < 3; ++k)
    squares += deviator[k] * deviator[k] + 2.0 * (deviator[k + 3] * deviator[k + 3]);
  set_root(norm, squares);
  const Lanes flows = norm > yield ? one : zero;
  if (!any(flows)) return 0;
  const Lanes beyond = 1.0 - yield / (flows != 0.0 ? norm : one);
  Lanes share = zero + points.rule.most;
  if (points.rule.stops_at_yield) share = beyond < share ? beyond : share;
  share = flows != 0.0 ? share : zero;
  for (int lane = 0; points.rule.growth > 0.0 && lane < kLanes; ++lane)
    if (share[lane] > 0.0) share[lane] = points.rule.find_share(norm[lane], yield[lane]);

  // exp(−2 E_p) = S⁻¹ b S⁻¹ of the b that is left; its logarithm from what it is over 1, which keeps small
  // strains.
  Lanes left[6], metric[6], plastic[6];
  for (int k = 0; k < 6; ++k) left[k] = 2.0 * (elastic[k] - share * deviator[k]);
  set_exponential(left, metric);
  Lanes strain[6], strain_squares[6];
  read_tensor(points.strain, begin, last, strain);
  set_symmetric_product(strain, strain, strain_squares);
  for (int k = 0; k < 6; ++k) metric[k] -= 2.0 * strain[k] + strain_squares[k];
  Real33<Lanes> middle, inverse, half, whole;
  set_symmetric(metric, middle);
  set_inverse(strain, inverse);
  multiply(inverse, middle, half);
  multiply(half, inverse, whole);
  const Lanes excess[6] = {whole.m[0],
                           whole.m[4],
                           whole.m[8],
                           0.5 * (whole.m[7] + whole.m[5]),
                           0.5 * (whole.m[6] + whole.m[2]),
                           0.5 * (whole.m[3] + whole.m[1])};
  set_half_logarithm(excess, plastic);
  // Flow keeps the volume: what else changes the trace is rounding.
  Lanes before[6];
  read_tensor(points.plastic_strain, begin, last, before);
  constexpr double kNoTrace = 1e-12;
  Lanes mean_before = (before[0] + before[1] + before[2]) / 3.0;
  mean_before = mean_before < kNoTrace && mean_before > -kNoTrace ? zero : mean_before;
  const Lanes trace = (plastic[0] + plastic[1] + plastic[2]) / 3.0;
  for (int k = 0; k < 6; ++k) plastic[k] = k < 3 ? mean_before - (plastic[k] - trace) : -kSqrt2 * plastic[k];
  Lanes plastic_squares = {};
  for (int k = 0; k < 6; ++k) plastic_squares += plastic[k] * plastic[k];
  const Lanes is_written = plastic_squares <= kMostPlastic * kMostPlastic ? one : zero;
  share = is_written != 0.0 ? share : zero;
  const Lanes loss = 2.0 * share * (1.0 - (points.is_balanced_after ? 1.0 : 0.5) * share) * squares;
  unsigned flowed = 0;
  for (int lane = 0; lane < static_cast<int>(end - begin); ++lane) {
    dissipated[lane] = share[lane] > 0.0 ? loss[lane] : 0.0;
    if (!(share[lane] > 0.0)) continue;
    flowed |= 1U << lane;
    for (int k = 0; k < 6; ++k) points.plastic_strain[6 * (begin + lane) + k] = plastic[k][lane];
  }
  return flowed;
}

namespace {

/// Perfectly plastic flow takes what a change of ε along dev ε_e would add to the stress, 2μ n nᵀ with n =
/// dev ε_e over its norm: of tets at their yield that do not leave it. Not quite all of it, so that the
/// tangent stays positive.
ARGIL_INLINE void set_spent(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end,
                            const ElasticStretch<Lanes>& stretch, const Lanes& mu,
                            PrincipalTangent<Lanes>& tangent) {
  constexpr double kMost = 0.98;
  const Lanes zero = {};
  Lanes yield, squares = {}, deviator[3];
  read_lanes<1>(tets.yield, begin, end - 1, &yield);
  for (int i = 0; i < 3; ++i) {
    deviator[i] = stretch.logarithm[i] - stretch.trace / 3.0;
    squares += deviator[i] * deviator[i];
  }
  Lanes flows = squares >= kAtYield * kAtYield * (yield * yield) ? zero + 1.0 : zero;
  for (std::ptrdiff_t p = begin; tets.unloads && p < end; ++p)
    if (tets.unloads[p] != 0) flows[p - begin] = 0.0;
  if (!any(flows)) return;
  Lanes least = tangent.normal[0];
  for (int i = 1; i < 3; ++i) least = tangent.normal[i] < least ? tangent.normal[i] : least;
  least = least < zero ? zero : least;
  least = 2.0 * mu < least ? 2.0 * mu : least;
  Lanes size;
  set_root(size, kMost * least / (flows != 0.0 ? squares : zero + 1.0));
  for (int i = 0; i < 3; ++i) tangent.spent[i] = flows != 0.0 ? size * deviator[i] : zero;
}

}  // namespace

ARGIL_EVERY_PROCESSOR void compute_hencky_stiffness(const TangentArrays& tets, std::ptrdiff_t begin,
                                                    std::ptrdiff_t end) {
  TangentLanes lanes;
  read_tangent_lanes(tets, begin, end, lanes);
  Lanes plastic[6];
  const bool is_plastic = read_plastic(tets.plastic_strain, begin, end - 1, plastic);
  ElasticStretch<Lanes> stretch;
  find_elastic_stretch(lanes.strain, is_plastic ? plastic : nullptr, stretch);
  Lanes tau[3];
  for (int i = 0; i < 3; ++i) tau[i] = 2.0 * lanes.mu * stretch.logarithm[i] + lanes.lambda * stretch.trace;
  PrincipalTangent<Lanes> tangent;
  set_principal_tangent(stretch, lanes.mu, tau, tangent);
  if (tets.yield) set_spent(tets, begin, end, stretch, lanes.mu, tangent);
  write_pair_blocks(tets, begin, end, lanes, stretch.N, lanes.lambda, tangent);
}

}  // namespace argil::solid
