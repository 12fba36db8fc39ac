#include "solid/tet_lanes.h"

#include "base/mandel.h"
#include "solid/lane_algebra.h"
#include "solid/pair_blocks.h"

namespace argil::solid {

ARGIL_EVERY_PROCESSOR void compute_corner_forces(const ForceArrays& tets, std::ptrdiff_t begin,
                                                 std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], plastic[6] = {}, lambda, mu, weight, gradient[12];
  Real33<Lanes> R;
  read_lanes<6>(tets.strain, begin, last, strain);
  if (tets.plastic_strain) read_lanes<6>(tets.plastic_strain, begin, last, plastic);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  read_lanes<9>(tets.R, begin, last, R.m);
  read_lanes<12>(tets.gradient, begin, last, gradient);

  // σ = 2μ ε_e + λ tr ε_e, as 11 22 33 23 13 12.
  constexpr double s = 1.0 / kSqrt2;
  const Lanes pressure =
      lambda * (strain[0] - plastic[0] + (strain[1] - plastic[1]) + (strain[2] - plastic[2]));
  const Lanes twice_mu = 2.0 * mu;
  Lanes sigma[6];
  for (int k = 0; k < 3; ++k) sigma[k] = twice_mu * (strain[k] - plastic[k]) + pressure;
  for (int k = 3; k < 6; ++k) sigma[k] = s * (twice_mu * (strain[k] - plastic[k]));

  // P in the turned frame: σ, and where plastic strain turns σ away from S = 1 + ε the rotation's own
  // derivative, −2[G⁻¹k]× with [k]× = skew(σS), G = tr(S) 1 − S.
  Real33<Lanes> P = {
      {sigma[0], sigma[5], sigma[4], sigma[5], sigma[1], sigma[3], sigma[4], sigma[3], sigma[2]}};
  Lanes plastic_size = {};  // 0: none; squares of what is smaller than 1e-160 are no matter
  for (int k = 0; k < 6; ++k) plastic_size += plastic[k] * plastic[k];
  if (!tets.is_linear && any(plastic_size)) {
    const Lanes S[6] = {strain[0] + 1.0, strain[1] + 1.0, strain[2] + 1.0,
                        s * strain[3],   s * strain[4],   s * strain[5]};
    // Axial vector of σS over 2: (σS)₃₂ − (σS)₂₃ and so on.
    const Lanes k[3] = {0.5 * (sigma[4] * S[5] + sigma[3] * S[1] + sigma[2] * S[3] -
                               (sigma[5] * S[4] + sigma[1] * S[3] + sigma[3] * S[2])),
                        0.5 * (sigma[0] * S[4] + sigma[5] * S[3] + sigma[4] * S[2] -
                               (sigma[4] * S[0] + sigma[3] * S[5] + sigma[2] * S[4])),
                        0.5 * (sigma[5] * S[0] + sigma[1] * S[5] + sigma[3] * S[4] -
                               (sigma[0] * S[5] + sigma[5] * S[1] + sigma[4] * S[3]))};
    const Real33<Lanes> G = {
        {S[1] + S[2], -S[5], -S[4], -S[5], S[0] + S[2], -S[3], -S[4], -S[3], S[0] + S[1]}};
    Real33<Lanes> adjugate;
    Lanes determinant;
    set_cofactor(G, adjugate, determinant);
    const Lanes scale = 2.0 / determinant;
    Lanes w[3];
    for (int i = 0; i < 3; ++i) {
      w[i] = scale * (adjugate.m[i] * k[0] + adjugate.m[3 + i] * k[1] + adjugate.m[6 + i] * k[2]);
      w[i] = plastic_size != 0.0 ? w[i] : Lanes{};
    }
    P.m[1] -= w[2];
    P.m[2] += w[1];
    P.m[3] += w[2];
    P.m[5] -= w[0];
    P.m[6] -= w[1];
    P.m[7] += w[0];
  }

  if (tets.pressure) {  // alike in all directions: no rotation's derivative sees it
    Lanes added;
    read_lanes<1>(tets.pressure, begin, last, &added);
    for (int k = 0; k < 9; k += 4) P.m[k] += added;
  }

  Real33<Lanes> piola;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      piola.m[3 * c + r] =
          weight * (R.m[r] * P.m[3 * c] + R.m[3 + r] * P.m[3 * c + 1] + R.m[6 + r] * P.m[3 * c + 2]);
  Lanes force[12];
  turn(piola, gradient, force);
  write_lanes<12>(force, begin, end, tets.corner_force);
}

ARGIL_EVERY_PROCESSOR double compute_energy(const ForceArrays& tets, std::ptrdiff_t begin,
                                            std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes strain[6], plastic[6], lambda, mu, weight;
  read_lanes<6>(tets.strain, begin, last, strain);
  read_lanes<6>(tets.plastic_strain, begin, last, plastic);
  read_lanes<1>(tets.lambda, begin, last, &lambda);
  read_lanes<1>(tets.mu, begin, last, &mu);
  read_lanes<1>(tets.weight, begin, last, &weight);
  Lanes squares = {};
  for (int k = 0; k < 6; ++k) squares += (strain[k] - plastic[k]) * (strain[k] - plastic[k]);
  const Lanes trace = strain[0] - plastic[0] + (strain[1] - plastic[1]) + (strain[2] - plastic[2]);
  const Lanes energy = weight * (mu * squares + 0.5 * lambda * trace * trace);
  double sum = 0.0;
  for (std::ptrdiff_t t = begin; t < end; ++t) sum += energy[t - begin];
  return sum;
}

ARGIL_EVERY_PROCESSOR void compute_kept_stiffness(const TangentArrays& points, std::ptrdiff_t begin,
                                                  std::ptrdiff_t end) {
  const std::ptrdiff_t last = end - 1;
  Lanes lambda, mu, weight, gradient[12], c[12];
  Real33<Lanes> R;
  read_lanes<1>(points.lambda, begin, last, &lambda);
  read_lanes<1>(points.mu, begin, last, &mu);
  read_lanes<1>(points.weight, begin, last, &weight);
  read_lanes<9>(points.F, begin, last, R.m);
  read_lanes<12>(points.gradient, begin, last, gradient);
  turn(R, gradient, c);
  const Lanes scaled_lambda = points.kept * weight * lambda, scaled_mu = points.kept * weight * mu;
  Lanes blocks[9 * kPairBlocks];
  int place = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i + 1; j < 4; ++j) {
      Real33<Lanes> block = {};
      add_kept_block(scaled_lambda, scaled_mu, c + 3 * i, c + 3 * j, block);
      for (int k = 0; k < 9; ++k) blocks[place++] = block.m[k];
    }
  write_blocks(blocks, begin, end, points.blocks);
}

}  // namespace argil::solid
