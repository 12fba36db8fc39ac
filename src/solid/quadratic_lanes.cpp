#include "solid/quadratic_lanes.h"

#include "mesh/quadratic.h"
#include "solid/block_lanes.h"
#include "solid/elements.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

constexpr double kGap = kPointFar - kPointNear;  // λ_a of point q: near, and by so much more where q = a

ARGIL_INLINE void write_three(const Quad& from, double* to) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}

ARGIL_INLINE void spread_forces(const double* of_points, double* of_nodes) {
  Quad sum[4] = {}, own[4], at[4][4] = {};
  for (int q = 0; q < 4; ++q)
    for (int a = 0; a < 4; ++a) {
      const double* force = of_points + 12 * q + 3 * a;
      at[q][a] = Quad{force[0], force[1], force[2], 0.0};
      sum[a] += at[q][a];
    }
  for (int a = 0; a < 4; ++a) {
    own[a] = (4.0 * kPointNear - 1.0) * sum[a] + 4.0 * kGap * at[a][a];
    write_three(own[a], of_nodes + 3 * a);
  }
  for (int edge = 0; edge < 6; ++edge) {
    const int a = mesh::kTetEdges[edge][0], b = mesh::kTetEdges[edge][1];
    const Quad force = 4.0 * kPointNear * (sum[a] + sum[b]) + 4.0 * kGap * (at[a][b] + at[b][a]);
    write_three(force, of_nodes + 3 * (4 + edge));
  }
}

/// Stiffness of the four corners at all points of a tet: K_ab summed, and of each point.
struct CornerBlocks {
  Block sum[4][4], at[4][4][4];

  ARGIL_INLINE void read_from(const double* of_points) {
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) sum[a][b] = Block{};
    for (int q = 0; q < 4; ++q) {
      Block(&K)[4][4] = at[q];
      for (int a = 0; a < 4; ++a) K[a][a] = Block{};
      for (int a = 0; a < 3; ++a)
        for (int b = a + 1; b < 4; ++b) {
          read_block(of_points + 9 * (kPairBlocks * q + find_pair(a, b)), K[a][b]);
          K[b][a] = K[a][b];
          transpose_block(K[b][a]);
          add(-1.0, K[a][b], K[a][a]);
          add(-1.0, K[b][a], K[b][b]);
        }
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) add(K[a][b], sum[a][b]);
    }
  }
  /// Adds `scale` Σ λ_a K_ib.
  ARGIL_INLINE void add_weighted(double scale, int a, int i, int b, Block& to) const {
    add(scale * kPointNear, sum[i][b], to);
    add(scale * kGap, at[a][i][b], to);
  }
  /// Adds `scale` Σ λ_a λ_c K_bd.
  ARGIL_INLINE void add_weighted(double scale, int a, int c, int b, int d, Block& to) const {
    add(scale * kPointNear * kPointNear, sum[b][d], to);
    if (a == c) {
      add(scale * kGap * (kPointNear + kPointFar), at[a][b][d], to);
    } else {
      add(scale * kGap * kPointNear, at[a][b][d], to);
      add(scale * kGap * kPointNear, at[c][b][d], to);
    }
  }
};

ARGIL_INLINE void spread_pairs(const double* of_points, double* of_nodes) {
  CornerBlocks K;
  K.read_from(of_points);
  constexpr double kLess = 4.0 * kPointNear - 1.0;
  for (int i = 0; i < 3; ++i)  // (4λᵢ − 1) (4λⱼ − 1) K_ij
    for (int j = i + 1; j < 4; ++j) {
      Block block = {};
      add(kLess * kLess, K.sum[i][j], block);
      add(kLess * 4.0 * kGap, K.at[i][i][j], block);
      add(kLess * 4.0 * kGap, K.at[j][i][j], block);
      write_block(block, of_nodes + 9 * find_pair<10>(i, j));
    }
  for (int i = 0; i < 4; ++i)  // (4λᵢ − 1) 4 (λ_a K_ib + λ_b K_ia)
    for (int edge = 0; edge < 6; ++edge) {
      const int a = mesh::kTetEdges[edge][0], b = mesh::kTetEdges[edge][1];
      Block block = {};
      K.add_weighted(16.0, i, a, i, b, block);
      K.add_weighted(16.0, i, b, i, a, block);
      K.add_weighted(-4.0, a, i, b, block);
      K.add_weighted(-4.0, b, i, a, block);
      write_block(block, of_nodes + 9 * find_pair<10>(i, 4 + edge));
    }
  for (int first = 0; first < 5; ++first)  // 16 (λ_a λ_c K_bd + λ_a λ_d K_bc + λ_b λ_c K_ad + λ_b λ_d K_ac)
    for (int second = first + 1; second < 6; ++second) {
      const int a = mesh::kTetEdges[first][0], b = mesh::kTetEdges[first][1];
      const int c = mesh::kTetEdges[second][0], d = mesh::kTetEdges[second][1];
      Block block = {};
      K.add_weighted(16.0, a, c, b, d, block);
      K.add_weighted(16.0, a, d, b, c, block);
      K.add_weighted(16.0, b, c, a, d, block);
      K.add_weighted(16.0, b, d, a, c, block);
      write_block(block, of_nodes + 9 * find_pair<10>(4 + first, 4 + second));
    }
}

}  // namespace

ARGIL_EVERY_PROCESSOR void set_node_forces(const double* of_points, std::ptrdiff_t begin, std::ptrdiff_t end,
                                           double* of_nodes) {
  for (std::ptrdiff_t t = begin; t < end; ++t) spread_forces(of_points + 48 * t, of_nodes + 30 * t);
}

ARGIL_EVERY_PROCESSOR void set_node_pairs(const double* of_points, std::ptrdiff_t begin, std::ptrdiff_t end,
                                          double* of_nodes) {
  for (std::ptrdiff_t t = begin; t < end; ++t)
    spread_pairs(of_points + 36 * kPairBlocks * t, of_nodes + 9 * kQuadraticPairs * t);
}

}  // namespace argil::solid
