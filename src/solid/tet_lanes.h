#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/change_marks.h"
#include "base/lanes.h"
#include "base/parallel.h"

namespace argil::solid {

// Points of tets, eight at a time. At a point a 10-node tet is a 4-node tet, too, with corners at Σ xᵢ
// ∂Nᵢ/∂λ: all but the first and the last step of the way from places to forces and rows is the same for both.

/// Arrays of a body as the loops below read and write them, column by column.
struct PointArrays {
  const double* x = nullptr;              ///< 3 a node
  const int* nodes = nullptr;             ///< 4 or 10 a tet
  const double* gradient = nullptr;       ///< ∇λ, 12 a point
  bool is_linear = false;                 ///< R = 1
  double* F = nullptr;                    ///< 9 a point; may be null: not wanted
  double* R = nullptr;                    ///< 9 a point
  double* turned_gradient = nullptr;      ///< Q ∇λ, 12 a point; may be null: not wanted
  double* frame = nullptr;                ///< Q, 9 a point: R, or an earlier one that is still near
  double frame_tolerance = 0.0;           ///< on ‖R − Q‖; beyond it Q becomes R
  double* strain = nullptr;               ///< ε, Mandel, 6 a point
  double* volume_ratio = nullptr;         ///< det F
  char* is_turned = nullptr;              ///< of tets; set to 1 where Q changed
  ChangeMarks* changed_frames = nullptr;  ///< of Q since the last commit; null: not wanted
  double* committed_frame = nullptr;      ///< where these have changed, what Q was before
  bool keeps_deformation = false;         ///< Q is F, or an earlier one; then no turned gradient is wanted
};

/// Runs of kLanes tets whose sums and least values are kept together, so that those of a large body are found
/// anew only where it moved.
inline constexpr std::ptrdiff_t kBatchGroup = 64;

/// F = Σ xᵢ ⊗ ∇Nᵢ, R, ε = sym(RᵀF) − 1 and det F of points begin … end−1, at most kLanes of them: of 4-node
/// tets, or of whole 10-node tets.
void compute_motions(const PointArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);
void compute_quadratic_motions(const PointArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Strain of a small displacement of turned 4-node tets.
struct StrainArrays {
  const double* u = nullptr;         ///< 3 a node
  const int* nodes = nullptr;        ///< 4 a tet
  const double* gradient = nullptr;  ///< ∇Nᵢ, 12 a tet
  const double* R = nullptr;         ///< 9 a tet
  double* strain = nullptr;          ///< Mandel, 6 a tet
};

/// sym(RᵀH), H = Σ uᵢ ⊗ ∇Nᵢ, of tets begin … end−1, at most kLanes of them.
void compute_strains(const StrainArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Elastic strains that a law finds by a logarithm, once until their points move or flow; null: every time.
struct ElasticArrays {
  double* strain = nullptr;  ///< 11 22 33 23 13 12, 6 a point
  char* is_known = nullptr;  ///< of each run of kLanes points; set to 1 where they were found
};

/// What forces are computed from.
struct ForceArrays {
  const double* gradient = nullptr;        ///< 12 a point
  const double* R = nullptr;               ///< 9 a point
  const double* strain = nullptr;          ///< 6 a point
  const double* plastic_strain = nullptr;  ///< 6 a point; may be null: none
  const double* weight = nullptr;          ///< volume
  const double* lambda = nullptr;          ///< 1 a point [Pa]
  const double* mu = nullptr;              ///< 1 a point [Pa]
  const double* pressure = nullptr;        ///< added to the stress, 1 a point [Pa]; may be null: none
  bool is_linear = false;                  ///< R = 1 has no derivative
  double* corner_force = nullptr;          ///< 12 a point [N]
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

/// Longest row of 4-node tets, and of 10-node ones, that the functions below can gather.
inline constexpr int kLongestRow = 96;
inline constexpr int kLongestQuadraticRow = 192;

/// Blocks first_block … first_block + num_blocks − 1 of one row: scale Σ V (λ cᵢ⊗cⱼ + μ cⱼ⊗cᵢ + μ cᵢ·cⱼ 1)
/// over the corners `begin` … `end` − 1, c the turned gradients.
void set_isotropic_row(const RowArrays& rows, int begin, int end, int first_block, int num_blocks);

/// Blocks (0,1) (0,2) (0,3) (1,2) (1,3) (2,3) of a 4-node tet's stiffness, which say all of it: those of a
/// row add up to nothing. Likewise (0,1) … (8,9) of a 10-node tet's.
inline constexpr int kPairBlocks = 6;
inline constexpr int kQuadraticPairs = 45;
/// Where among those of N nodes that of i and j ≠ i stands.
template <int N = 4>
constexpr int find_pair(int i, int j) {
  const int first = i < j ? i : j, second = i < j ? j : i;
  return first * (2 * N - first - 1) / 2 + second - first - 1;
}

/// Stiffness of points, from the frame that each had when it was last made.
struct TangentArrays {
  const double* gradient = nullptr;        ///< 12 a point
  const double* F = nullptr;               ///< 9 a point: Q, of a quadratic law R, else F
  const double* plastic_strain = nullptr;  ///< 6 a point
  const double* weight = nullptr;          ///< volume
  const double* lambda = nullptr;          ///< 1 a point [Pa]
  const double* mu = nullptr;              ///< 1 a point [Pa]
  double exact = 1.0;                      ///< how often ∂²W/∂x² enters, its negative modes left out
  double kept = 0.0;                       ///< and the stiffness of the shape at rest, turned by R
  double* blocks = nullptr;                ///< kPairBlocks 3×3 a point, of the pairs of its corners
  const double* yield = nullptr;           ///< ‖dev ε_e‖ at which a point flows; null: none does
  const char* unloads = nullptr;           ///< 1 a point: leaves its yield, and is elastic
};

/// Stiffness of points of a law that is quadratic in the strain of their frame.
void compute_kept_stiffness(const TangentArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end);

/// What rows of the matrix are gathered from where each tet's stiffness is known.
struct PairArrays {
  const double* pairs = nullptr;       ///< kPairBlocks 3×3 a tet, or kQuadraticPairs
  const int* corners = nullptr;        ///< as in RowArrays
  const int* block_of_pair = nullptr;  ///< as in RowArrays
  double* values = nullptr;            ///< 9 a block
};

/// The same row of such tets, of 4 or 10 nodes.
void set_row_of_pairs(const PairArrays& rows, int begin, int end, int first_block, int num_blocks);
void set_row_of_quadratic_pairs(const PairArrays& rows, int begin, int end, int first_block, int num_blocks);

/// Sum of the forces on corners `begin` … `end` − 1 of `corners`; each force with a number after it.
void sum_corner_forces(const double* corner_force, const int* corners, int begin, int end, double* force);

}  // namespace argil::solid
