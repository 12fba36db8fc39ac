#pragma once

// Stiffness of points of an isotropic law, eight side by side.

#include <algorithm>

#include "base/mandel.h"
#include "solid/lane_algebra.h"
#include "solid/polar_newton.h"
#include "solid/principal_tangent.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

ARGIL_INLINE void read_tensor(const double* from, std::ptrdiff_t begin, std::ptrdiff_t last, Lanes* tensor) {
  constexpr double kShear = 1.0 / kSqrt2;  // of a Mandel shear
  read_lanes<6>(from, begin, last, tensor);
  for (int k = 3; k < 6; ++k) tensor[k] *= kShear;
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

/// λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1.
ARGIL_INLINE void add_kept_block(const Lanes& lambda, const Lanes& mu, const Lanes* ci, const Lanes* cj,
                                 Real33<Lanes>& block) {
  const Lanes dot = mu * (ci[0] * cj[0] + ci[1] * cj[1] + ci[2] * cj[2]);
  for (int s = 0; s < 3; ++s)
    for (int r = 0; r < 3; ++r) block.m[3 * s + r] += lambda * (ci[r] * cj[s]) + mu * (cj[r] * ci[s]);
  for (int k = 0; k < 3; ++k) block.m[4 * k] += dot;
}

/// A block of the stiffness in the directions of b. g: ∇N after the motion; c: at rest, turned.
struct PairBlock {
  const PrincipalTangent<Lanes>& tangent;
  const Lanes& lambda;
  bool flows;
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
    for (int s = 0; flows && s < 3; ++s)
      for (int r = 0; r < 3; ++r)
        block.m[3 * s + r] -= (tangent.spent[r] * gi[r]) * (tangent.spent[s] * gj[s]);
    if (has_kept) add_kept_block(kept_lambda, kept_mu, ci, cj, block);
  }
};

/// Tets as a law of large strain finds its tangent from.
struct TangentLanes {
  Lanes strain[6];  ///< S − 1 of F = R S
  Real33<Lanes> R;
  Lanes lambda, mu;  ///< [Pa]
};

ARGIL_INLINE void read_tangent_lanes(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end,
                                     TangentLanes& lanes) {
  const std::ptrdiff_t last = end - 1;
  Real33<Lanes> F;
  read_lanes<9>(tets.F, begin, last, F.m);
  read_lanes<1>(tets.lambda, begin, last, &lanes.lambda);
  read_lanes<1>(tets.mu, begin, last, &lanes.mu);
  find_rotation(F, lanes.R);
  set_strain(lanes.R, F, lanes.strain);
}

/// Blocks of tets begin … end−1. N: directions of b in the frame of R; lambda: what multiplies tr l on the
/// diagonal [Pa].
ARGIL_INLINE void write_pair_blocks(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end,
                                    const TangentLanes& lanes, const Real33<Lanes>& N, const Lanes& lambda,
                                    PrincipalTangent<Lanes>& tangent) {
  const std::ptrdiff_t last = end - 1;
  Lanes weight, gradient[12];
  read_lanes<1>(tets.weight, begin, last, &weight);
  read_lanes<12>(tets.gradient, begin, last, gradient);
  make_positive(lanes.mu, tangent);
  const Lanes exact = tets.exact * weight;
  for (int k = 0; k < 3; ++k) {
    tangent.normal[k] *= exact;
    tangent.own[k] *= exact;
    tangent.next[k] *= exact;
    tangent.coupling[k] *= exact;
  }
  const Lanes exact_lambda = exact * lambda;
  const Lanes kept_lambda = tets.kept * weight * lanes.lambda, kept_mu = tets.kept * weight * lanes.mu;

  Real33<Lanes> inverse, directions;
  set_inverse(lanes.strain, inverse);
  multiply(lanes.R, N, directions);
  Lanes moved[12], g[12], c[12];
  turn(inverse, gradient, moved);
  turn_back(N, moved, g);
  turn_back(N, gradient, c);
  bool flows = false;
  Lanes root;
  set_root(root, exact);
  for (int k = 0; k < 3; ++k) {
    tangent.spent[k] *= root;
    flows = flows || any(tangent.spent[k]);
  }
  const PairBlock pair{tangent, exact_lambda, flows, tets.kept != 0.0, kept_lambda, kept_mu};
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
