#include "solid/hencky_lanes.h"

#include "base/mandel.h"
#include "solid/hencky_point.h"
#include "solid/lane_algebra.h"

namespace argil::solid {
namespace {

constexpr double kShear = 1.0 / kSqrt2;  // of a Mandel shear

ARGIL_INLINE void read_tensor(const double* from, std::ptrdiff_t begin, std::ptrdiff_t last, Lanes* tensor) {
  read_lanes<6>(from, begin, last, tensor);
  for (int k = 3; k < 6; ++k) tensor[k] *= kShear;
}

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

/// S⁻¹ of S = 1 + ε, as a 3×3.
ARGIL_INLINE void set_inverse(const Lanes* strain, Real33<Lanes>& inverse) {
  Real33<Lanes> S;
  Lanes determinant;
  set_symmetric(strain, S);
  for (int k = 0; k < 9; k += 4) S.m[k] += 1.0;
  set_cofactor(S, inverse, determinant);
  const Lanes scale = 1.0 / determinant;
  for (int k = 0; k < 9; ++k) inverse.m[k] *= scale;
}

/// S − 1 of F = R S.
ARGIL_INLINE void set_strain(const Real33<Lanes>& R, const Real33<Lanes>& F, Lanes* strain) {
  set_turned_tensor(R, F, strain);
  for (int k = 0; k < 3; ++k) strain[k] -= 1.0;
}

/// 54 numbers of each of tets begin … end−1.
ARGIL_INLINE void write_blocks(const Lanes* blocks, std::ptrdiff_t begin, std::ptrdiff_t end, double* to) {
  constexpr int kCount = 9 * kPairBlocks;
  double* first = to + kCount * begin;
  if (end - begin < kLanes) {
    for (int lane = 0; lane < static_cast<int>(end - begin); ++lane)
      for (int k = 0; k < kCount; ++k) first[kCount * lane + k] = blocks[k][lane];
    return;
  }
  Lanes eight[8];
  int k = 0;
  for (; k + kLanes <= kCount; k += kLanes) {
    for (int i = 0; i < kLanes; ++i) eight[i] = blocks[k + i];
    write_rows<kLanes>(eight, kCount, first + k);
  }
  for (int i = 0; i < kLanes; ++i) eight[i] = blocks[std::min(k + i, kCount - 1)];
  write_rows<6>(eight, kCount, first + k);
}

/// A block of the stiffness in the directions of b. g: ∇N after the motion; c: at rest, turned.
struct PairBlock {
  const PrincipalTangent<Lanes>& tangent;
  const Lanes& lambda;
  bool has_kept;
  const Lanes& kept_lambda;
  const Lanes& kept_mu;

  ARGIL_INLINE void set(const Lanes* gi, const Lanes* gj, const Lanes* ci, const Lanes* cj,
                        Real33<Lanes>& block) const {
    for (int s = 0; s < 3; ++s)
      for (int r = 0; r < 3; ++r) block.m[3 * s + r] = lambda * (gi[r] * gj[s]);
    for (int k = 0; k < 3; ++k) block.m[4 * k] += tangent.normal[k] * (gi[k] * gj[k]);
    for (int k = 0; k < 3; ++k) {
      const int a = kPlanes[k][0], b = kPlanes[k][1];
      block.m[4 * a] += tangent.own[k] * (gi[b] * gj[b]);
      block.m[4 * b] += tangent.next[k] * (gi[a] * gj[a]);
      block.m[3 * b + a] += tangent.coupling[k] * (gi[b] * gj[a]);
      block.m[3 * a + b] += tangent.coupling[k] * (gi[a] * gj[b]);
    }
    if (!has_kept) return;
    const Lanes dot = kept_mu * (ci[0] * cj[0] + ci[1] * cj[1] + ci[2] * cj[2]);
    for (int s = 0; s < 3; ++s)
      for (int r = 0; r < 3; ++r)
        block.m[3 * s + r] += kept_lambda * (ci[r] * cj[s]) + kept_mu * (cj[r] * ci[s]);
    for (int k = 0; k < 3; ++k) block.m[4 * k] += dot;
  }
};

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

ARGIL_EVERY_PROCESSOR unsigned flow_by_hencky(const FlowArrays& points, std::ptrdiff_t begin,
                                              std::ptrdiff_t end, double* released) {
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
  Lanes share = zero + points.most;
  if (points.stops_at_yield) share = beyond < share ? beyond : share;
  share = flows != 0.0 ? share : zero;

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
  const Lanes trace = (plastic[0] + plastic[1] + plastic[2]) / 3.0;  // what rounding left
  for (int k = 0; k < 6; ++k) plastic[k] = -(k < 3 ? plastic[k] - trace : kSqrt2 * plastic[k]);
  const Lanes loss = squares - (1.0 - share) * (1.0 - share) * squares;
  unsigned flowed = 0;
  for (int lane = 0; lane < static_cast<int>(end - begin); ++lane) {
    released[lane] = share[lane] > 0.0 ? loss[lane] : 0.0;
    if (!(share[lane] > 0.0)) continue;
    flowed |= 1U << lane;
    for (int k = 0; k < 6; ++k) points.plastic_strain[6 * (begin + lane) + k] = plastic[k][lane];
  }
  return flowed;
}

ARGIL_EVERY_PROCESSOR void compute_hencky_stiffness(const TangentArrays& tets, std::ptrdiff_t begin,
                                                    std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], lambda, mu, weight, gradient[12];
  Real33<Lanes> F, R;
  read_lanes<9>(tets.F, begin, last, F.m);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  read_lanes<12>(tets.gradient, begin, last, gradient);
  find_rotation(F, R);
  set_strain(R, F, strain);
  Lanes plastic[6];
  const bool is_plastic = read_plastic(tets.plastic_strain, begin, last, plastic);
  ElasticStretch<Lanes> stretch;
  find_elastic_stretch(strain, is_plastic ? plastic : nullptr, stretch);

  Lanes tau[3];
  for (int i = 0; i < 3; ++i) tau[i] = 2.0 * mu * stretch.logarithm[i] + lambda * stretch.trace;
  PrincipalTangent<Lanes> tangent;
  set_principal_tangent(stretch, mu, tau, tangent);
  make_positive(mu, tangent);
  const Lanes exact = tets.exact * weight;
  for (int k = 0; k < 3; ++k) {
    tangent.normal[k] *= exact;
    tangent.own[k] *= exact;
    tangent.next[k] *= exact;
    tangent.coupling[k] *= exact;
  }
  const Lanes exact_lambda = exact * lambda;
  const Lanes kept_lambda = tets.kept * weight * lambda, kept_mu = tets.kept * weight * mu;

  Real33<Lanes> inverse, directions;
  set_inverse(strain, inverse);
  multiply(R, stretch.N, directions);
  Lanes moved[12], g[12], c[12];
  turn(inverse, gradient, moved);
  turn_back(stretch.N, moved, g);
  turn_back(stretch.N, gradient, c);
  const PairBlock pair{tangent, exact_lambda, tets.kept != 0.0, kept_lambda, kept_mu};
  Lanes blocks[9 * kPairBlocks];
  int place = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 4; ++j) {
      Real33<Lanes> block, half, turned;
      pair.set(g + 3 * i, g + 3 * j, c + 3 * i, c + 3 * j, block);
      multiply(directions, block, half);
      multiply_transposed(half, directions, turned);
      for (int k = 0; k < 9; ++k) blocks[place++] = turned.m[k];
    }
  write_blocks(blocks, begin, end, tets.blocks);
}

}  // namespace argil::solid
