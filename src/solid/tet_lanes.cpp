#include "solid/tet_lanes.h"

#include "base/mandel.h"
#include "solid/lane_algebra.h"
#include "solid/polar_newton.h"

namespace argil::solid {
namespace {

/// Σ uᵢ ⊗ ∇Nᵢ of tets begin … end−1.
ARGIL_INLINE void set_gradient(const double* u, const int* of_tet, const Lanes* gradient,
                               std::ptrdiff_t begin, std::ptrdiff_t end, Real33<Lanes>& H) {
  Lanes corner[12];
  for (int lane = 0; lane < kLanes; ++lane) {
    const int* nodes = of_tet + 4 * std::min(begin + lane, end - 1);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) corner[3 * i + k][lane] = u[3 * nodes[i] + k];
  }
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      H.m[3 * c + r] = corner[r] * gradient[c] + corner[3 + r] * gradient[3 + c] +
                       corner[6 + r] * gradient[6 + c] + corner[9 + r] * gradient[9 + c];
}

/// sym(RᵀH), Mandel.
ARGIL_INLINE void set_turned_strain(const Real33<Lanes>& R, const Real33<Lanes>& H, Lanes* strain) {
  set_turned_tensor(R, H, strain);
  for (int k = 3; k < 6; ++k) strain[k] = kSqrt2 * strain[k];
}

/// Tet t, which leaves its frame.
ARGIL_INLINE void replace_frame(const TetArrays& tets, const Real33<Lanes>& Q, std::ptrdiff_t t,
                                std::ptrdiff_t lane) {
  tets.is_turned[t] = 1;
  if (tets.changed_frames && tets.changed_frames->set(static_cast<std::size_t>(t)))
    std::copy_n(tets.frame + 9 * t, 9, tets.committed_frame + 9 * t);
  for (int k = 0; k < 9; ++k) tets.frame[9 * t + k] = Q.m[k][lane];
}

/// Where F left that of the kept stiffness.
ARGIL_INLINE void replace_deformations(const TetArrays& tets, const Real33<Lanes>& F, std::ptrdiff_t begin,
                                       std::ptrdiff_t end) {
  Lanes frame[9], squares = {};
  read_lanes<9>(tets.frame, begin, end - 1, frame);
  for (int k = 0; k < 9; ++k) squares += (F.m[k] - frame[k]) * (F.m[k] - frame[k]);
  const Lanes is_changed = squares > tets.frame_tolerance * tets.frame_tolerance ? Lanes{} + 1.0 : Lanes{};
  if (!any(is_changed)) return;
  for (std::ptrdiff_t t = begin; t < end; ++t)
    if (is_changed[t - begin] != 0.0) replace_frame(tets, F, t, t - begin);
}

/// Where R left the frame of the turned gradient: another frame, another gradient.
ARGIL_INLINE void turn_frames(const TetArrays& tets, const Real33<Lanes>& R, const Lanes* gradient,
                              std::ptrdiff_t begin, std::ptrdiff_t end) {
  Lanes frame[8];
  read_eight<9>(tets.frame, begin, end - 1, frame);
  Lanes squares = {};  // of eight entries: the ninth follows from them
  for (int k = 0; k < 8; ++k) squares += (R.m[k] - frame[k]) * (R.m[k] - frame[k]);
  const Lanes is_turned = squares > tets.frame_tolerance * tets.frame_tolerance ? Lanes{} + 1.0 : Lanes{};
  if (!any(is_turned)) return;
  Lanes turned[12];
  turn(R, gradient, turned);
  for (std::ptrdiff_t t = begin; t < end; ++t) {
    const std::ptrdiff_t lane = t - begin;
    if (is_turned[lane] == 0.0) continue;
    replace_frame(tets, R, t, lane);
    for (int k = 0; k < 12; ++k) tets.turned_gradient[12 * t + k] = turned[k][lane];
  }
}

}  // namespace

ARGIL_EVERY_PROCESSOR void compute_motions(const TetArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end) {
  Lanes gradient[12];
  read_lanes<12>(tets.gradient, begin, end - 1, gradient);

  Real33<Lanes> F, R;
  set_gradient(tets.x, tets.nodes, gradient, begin, end, F);
  if (tets.is_linear) {
    for (int k = 0; k < 9; ++k) R.m[k] = Lanes{} + (k % 4 == 0 ? 1.0 : 0.0);
  } else {
    find_rotation(F, R);
  }

  Lanes strain[6];
  set_turned_strain(R, F, strain);
  for (int k = 0; k < 3; ++k) strain[k] -= 1.0;
  Real33<Lanes> cofactor;
  Lanes determinant;
  set_cofactor(F, cofactor, determinant);

  if (tets.F) write_lanes<9>(F.m, begin, end, tets.F);
  write_lanes<9>(R.m, begin, end, tets.R);
  write_lanes<6>(strain, begin, end, tets.strain);
  write_lanes<1>(&determinant, begin, end, tets.volume_ratio);
  if (tets.keeps_deformation)
    replace_deformations(tets, F, begin, end);
  else if (tets.turned_gradient)
    turn_frames(tets, R, gradient, begin, end);
}

ARGIL_EVERY_PROCESSOR void compute_strains(const StrainArrays& tets, std::ptrdiff_t begin,
                                           std::ptrdiff_t end) {
  Lanes gradient[12], strain[6];
  Real33<Lanes> R, H;
  read_lanes<12>(tets.gradient, begin, end - 1, gradient);
  read_lanes<9>(tets.R, begin, end - 1, R.m);
  set_gradient(tets.u, tets.nodes, gradient, begin, end, H);
  set_turned_strain(R, H, strain);
  write_lanes<6>(strain, begin, end, tets.strain);
}

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

/// A 3×3 block, column by column.
struct Block {
  Lanes eight;
  double last;
};

ARGIL_INLINE void add(const Block& a, Block& sum) {
  sum.eight += a.eight;
  sum.last += a.last;
}

/// The gradients of a tet add up to nothing, and so do the blocks of a row.
ARGIL_INLINE void set_diagonal(Block* sum, int diagonal, int num_blocks) {
  Block others = {};
  for (int k = 0; k <= num_blocks; ++k)
    if (k != diagonal) add(sum[k], others);
  sum[diagonal].eight = -others.eight;
  sum[diagonal].last = -others.last;
}

ARGIL_INLINE void write_row(const Block* sum, int num_blocks, double* out) {
  for (int k = 0; k < num_blocks; ++k) {
    write(sum[k].eight, out + 9 * k);
    out[9 * k + 8] = sum[k].last;
  }
}

/// Asks for what the row of one corner is gathered from, which lies here and there.
ARGIL_INLINE void prefetch_corner(const RowArrays& rows, int corner) {
  const std::ptrdiff_t tet = corner / 4;
  __builtin_prefetch(rows.turned_gradient + 12 * tet);
  __builtin_prefetch(rows.turned_gradient + 12 * tet + 8);
  __builtin_prefetch(rows.block_of_pair + 4 * static_cast<std::ptrdiff_t>(corner));
  __builtin_prefetch(rows.weight + tet);
  __builtin_prefetch(rows.lambda + tet);
  __builtin_prefetch(rows.mu + tet);
}

ARGIL_EVERY_PROCESSOR void set_isotropic_row(const RowArrays& rows, int begin, int end, int first_block,
                                             int num_blocks) {
  Block sum[kLongestRow + 1];  // the last one is of nodes without a row
  std::fill(sum, sum + num_blocks + 1, Block{});
  constexpr int kAhead = 5;
  int diagonal = 0;
  for (int c = begin; c < end; ++c) {
    prefetch_corner(rows, rows.corners[std::min(c + kAhead, end - 1)]);
    const int corner = rows.corners[c];
    const int i = corner % 4;
    const std::ptrdiff_t tet = corner / 4;
    const double* gradient = rows.turned_gradient + 12 * tet;
    const double* own = gradient + 3 * i;
    const Quad ci = {own[0], own[1], own[2], 0.0};
    const double weight = rows.scale * rows.weight[tet];
    const Quad li = weight * rows.lambda[tet] * ci;
    const Quad mi = weight * rows.mu[tet] * ci;
    const Lanes li_rows = __builtin_shufflevector(li, li, 0, 1, 2, 0, 1, 2, 0, 1);
    const Lanes mi_columns = __builtin_shufflevector(mi, mi, 0, 0, 0, 1, 1, 1, 2, 2);
    const double last = li[2] + mi[2];
    const int* blocks = rows.block_of_pair + 4 * static_cast<std::ptrdiff_t>(corner);
    diagonal = blocks[i] - first_block;
    for (int j = 0; j < 4; ++j) {
      if (j == i) continue;
      const double* other = gradient + 3 * j;
      const Quad cj = {other[0], other[1], other[2], 0.0};
      const Quad product = mi * cj;
      const double dot = product[0] + product[1] + product[2];
      const Lanes cj_rows = __builtin_shufflevector(cj, cj, 0, 1, 2, 0, 1, 2, 0, 1);
      const Lanes cj_columns = __builtin_shufflevector(cj, cj, 0, 0, 0, 1, 1, 1, 2, 2);
      Block& block = sum[blocks[j] < 0 ? num_blocks : blocks[j] - first_block];
      block.eight +=
          li_rows * cj_columns + cj_rows * mi_columns + Lanes{dot, 0.0, 0.0, 0.0, dot, 0.0, 0.0, 0.0};
      block.last += last * cj[2] + dot;
    }
  }
  set_diagonal(sum, diagonal, num_blocks);
  write_row(sum, num_blocks, rows.values + 9 * static_cast<std::ptrdiff_t>(first_block));
}

ARGIL_INLINE void read_block(const double* from, Block& block) {
  read(from, block.eight);
  block.last = from[8];
}

ARGIL_INLINE void transpose_block(Block& block) {
  block.eight = __builtin_shufflevector(block.eight, block.eight, 0, 3, 6, 1, 4, 7, 2, 5);
}

ARGIL_EVERY_PROCESSOR void set_row_of_pairs(const PairArrays& rows, int begin, int end, int first_block,
                                            int num_blocks) {
  Block sum[kLongestRow + 1];  // the last one is of nodes without a row
  std::fill(sum, sum + num_blocks + 1, Block{});
  int diagonal = 0;
  for (int c = begin; c < end; ++c) {
    const int corner = rows.corners[c];
    const int i = corner % 4;
    const double* of_tet = rows.pairs + 9 * kPairBlocks * static_cast<std::ptrdiff_t>(corner / 4);
    const int* blocks = rows.block_of_pair + 4 * static_cast<std::ptrdiff_t>(corner);
    diagonal = blocks[i] - first_block;
    for (int j = 0; j < 4; ++j) {
      if (j == i) continue;
      Block pair;
      read_block(of_tet + 9 * find_pair(i, j), pair);
      if (j < i) transpose_block(pair);
      add(pair, sum[blocks[j] < 0 ? num_blocks : blocks[j] - first_block]);
    }
  }
  set_diagonal(sum, diagonal, num_blocks);
  write_row(sum, num_blocks, rows.values + 9 * static_cast<std::ptrdiff_t>(first_block));
}

ARGIL_EVERY_PROCESSOR void sum_corner_forces(const double* corner_force, const int* corners, int begin,
                                             int end, double* force) {
  Quad even = {}, odd = {}, of_corner;  // even and odd apart, so that no sum waits for the one before it
  int c = begin;
  for (; c + 1 < end; c += 2) {
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c]), of_corner);
    even += of_corner;
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c + 1]), of_corner);
    odd += of_corner;
  }
  if (c < end) {
    read(corner_force + 3 * static_cast<std::ptrdiff_t>(corners[c]), of_corner);
    even += of_corner;
  }
  even += odd;
  for (int k = 0; k < 3; ++k) force[k] = even[k];
}

}  // namespace argil::solid
