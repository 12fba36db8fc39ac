#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/change_marks.h"
#include "base/lanes.h"
#include "base/parallel.h"

namespace argil::solid {

/// Arrays of a body of 4-node tets as the loops below read and write them, column by column.
struct TetArrays {
  const double* x = nullptr;              ///< 3 a node
  const int* nodes = nullptr;             ///< 4 a tet
  const double* gradient = nullptr;       ///< ∇Nᵢ, 12 a tet
  bool is_linear = false;                 ///< R = 1
  double* F = nullptr;                    ///< 9 a tet; may be null: not wanted
  double* R = nullptr;                    ///< 9 a tet
  double* turned_gradient = nullptr;      ///< Q ∇Nᵢ, 12 a tet; may be null: not wanted
  double* frame = nullptr;                ///< Q, 9 a tet: R, or an earlier one that is still near
  double frame_tolerance = 0.0;           ///< on ‖R − Q‖; beyond it Q becomes R
  double* strain = nullptr;               ///< ε, Mandel, 6 a tet
  double* volume_ratio = nullptr;         ///< det F
  char* is_turned = nullptr;              ///< set to 1 where Q changed
  ChangeMarks* changed_frames = nullptr;  ///< of Q since the last commit; null: not wanted
  double* committed_frame = nullptr;      ///< where these have changed, what Q was before
  bool keeps_deformation = false;         ///< Q is F, or an earlier one; then no turned gradient is wanted
};

/// Runs of kLanes tets whose sums and least values are kept together, so that those of a large body are found
/// anew only where it moved.
inline constexpr std::ptrdiff_t kBatchGroup = 64;

/// F = Σ xᵢ ⊗ ∇Nᵢ, R, ε = sym(RᵀF) − 1 and det F of tets begin … end−1, at most kLanes of them.
void compute_motions(const TetArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Strain of a small displacement of turned tets.
struct StrainArrays {
  const double* u = nullptr;         ///< 3 a node
  const int* nodes = nullptr;        ///< 4 a tet
  const double* gradient = nullptr;  ///< ∇Nᵢ, 12 a tet
  const double* R = nullptr;         ///< 9 a tet
  double* strain = nullptr;          ///< Mandel, 6 a tet
};

/// sym(RᵀH), H = Σ uᵢ ⊗ ∇Nᵢ, of tets begin … end−1, at most kLanes of them.
void compute_strains(const StrainArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Elastic strains that a law finds by a logarithm, once until their tets move or flow; null: every time.
struct ElasticArrays {
  double* strain = nullptr;  ///< 11 22 33 23 13 12, 6 a tet
  char* is_known = nullptr;  ///< of each run of kLanes tets; set to 1 where they were found
};

/// What forces are computed from.
struct ForceArrays {
  const double* gradient = nullptr;        ///< 12 a tet
  const double* R = nullptr;               ///< 9 a tet
  const double* strain = nullptr;          ///< 6 a tet
  const double* plastic_strain = nullptr;  ///< 6 a tet; may be null: none
  const double* weight = nullptr;          ///< volume
  const double* lambda = nullptr;          ///< 1 a tet [Pa]
  const double* mu = nullptr;              ///< 1 a tet [Pa]
  const double* pressure = nullptr;        ///< added to the stress, 1 a tet [Pa]; may be null: none
  bool is_linear = false;                  ///< R = 1 has no derivative
  double* corner_force = nullptr;          ///< 12 a tet [N]
  ElasticArrays elastic = {};
};

/// fᵢ = V P ∇Nᵢ of the isotropic linear and corotational laws, as compute_piola has them.
void compute_corner_forces(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Their elastic energy V (μ ε_e:ε_e + ½ λ (tr ε_e)²) [J], of tets begin … end−1.
double compute_energy(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// What rows of the matrix are gathered from.
struct RowArrays {
  const double* turned_gradient = nullptr;  ///< 12 a tet
  const double* weight = nullptr;           ///< volume, 1 a tet
  const double* lambda = nullptr;           ///< 1 a tet [Pa]
  const double* mu = nullptr;               ///< 1 a tet [Pa]
  double scale = 1.0;                       ///< of all blocks
  const int* corners = nullptr;             ///< 4·tet + corner of each tet around each node
  const int* block_of_pair = nullptr;       ///< 16 a tet: place of block (i, j), −1 where there is none
  double* values = nullptr;                 ///< 9 a block
};

/// Longest row that set_isotropic_row can gather.
inline constexpr int kLongestRow = 96;

/// Blocks first_block … first_block + num_blocks − 1 of one row: scale Σ V (λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1)
/// over the corners `begin` … `end` − 1, c the turned gradients.
void set_isotropic_row(const RowArrays& rows, int begin, int end, int first_block, int num_blocks);

/// Blocks (0,1) (0,2) (0,3) (1,2) (1,3) (2,3) of a tet's stiffness, which say all of it: those of a row add
/// up to nothing.
inline constexpr int kPairBlocks = 6;
/// Where among them that of corners i and j ≠ i stands.
inline constexpr int find_pair(int i, int j) {
  constexpr int kPlace[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
  return kPlace[i][j];
}

/// Stiffness of tets, from the deformation F that each had when it was last made.
struct TangentArrays {
  const double* gradient = nullptr;        ///< 12 a tet
  const double* F = nullptr;               ///< 9 a tet
  const double* plastic_strain = nullptr;  ///< 6 a tet
  const double* weight = nullptr;          ///< volume
  const double* lambda = nullptr;          ///< 1 a tet [Pa]
  const double* mu = nullptr;              ///< 1 a tet [Pa]
  double exact = 1.0;                      ///< how often ∂²W/∂x² enters, its negative modes left out
  double kept = 0.0;                       ///< and the stiffness of the shape at rest, turned by R
  double* blocks = nullptr;                ///< kPairBlocks 3×3 a tet, of the pairs of its corners
  const double* yield = nullptr;           ///< ‖dev ε_e‖ at which a tet flows; null: none does
};

/// What rows of the matrix are gathered from where each tet's stiffness is known.
struct PairArrays {
  const double* pairs = nullptr;       ///< kPairBlocks 3×3 a tet
  const int* corners = nullptr;        ///< as in RowArrays
  const int* block_of_pair = nullptr;  ///< as in RowArrays
  double* values = nullptr;            ///< 9 a block
};

/// The same row of such tets.
void set_row_of_pairs(const PairArrays& rows, int begin, int end, int first_block, int num_blocks);

/// Sum of the forces on corners `begin` … `end` − 1 of `corners`; each force with a number after it.
void sum_corner_forces(const double* corner_force, const int* corners, int begin, int end, double* force);

}  // namespace argil::solid
