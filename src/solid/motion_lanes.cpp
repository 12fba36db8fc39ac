// Where points are and how they are turned and strained.

#include "solid/tet_lanes.h"

#include "base/mandel.h"
#include "mesh/quadratic.h"
#include "solid/elements.h"
#include "solid/lane_algebra.h"
#include "solid/polar_newton.h"

namespace argil::solid {
namespace {

/// Σ uᵢ ⊗ ∇λᵢ of corners that move by u.
ARGIL_INLINE void add_up(const Lanes* corner, const Lanes* gradient, Real33<Lanes>& H) {
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      H.m[3 * c + r] = corner[r] * gradient[c] + corner[3 + r] * gradient[3 + c] +
                       corner[6 + r] * gradient[6 + c] + corner[9 + r] * gradient[9 + c];
}

/// Σ uᵢ ⊗ ∇Nᵢ of 4-node tets begin … end−1.
ARGIL_INLINE void set_gradient(const double* u, const int* of_tet, const Lanes* gradient,
                               std::ptrdiff_t begin, std::ptrdiff_t end, Real33<Lanes>& H) {
  Lanes corner[12];
  for (int lane = 0; lane < kLanes; ++lane) {
    const int* nodes = of_tet + 4 * std::min(begin + lane, end - 1);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) corner[3 * i + k][lane] = u[3 * nodes[i] + k];
  }
  add_up(corner, gradient, H);
}

/// The same at the points begin … end−1 of one or two 10-node tets, whose corners are at Σ uᵢ ∂Nᵢ/∂λ.
ARGIL_INLINE void set_quadratic_gradient(const double* u, const int* of_tet, const Lanes* gradient,
                                         std::ptrdiff_t begin, std::ptrdiff_t end, Real33<Lanes>& H) {
  const int* first = of_tet + 10 * (begin / 4);
  const int* second = of_tet + 10 * ((end - 1) / 4);
  Lanes four_lambda[4], corner[12];
  for (int a = 0; a < 4; ++a) {
    four_lambda[a] = Lanes{} + 4.0 * kPointNear;
    four_lambda[a][a] = four_lambda[a][a + 4] = 4.0 * kPointFar;
  }
  for (int k = 0; k < 3; ++k) {
    Lanes node[10] = {};
    for (int i = 0; i < 10; ++i) {
      const double a = u[3 * first[i] + k], b = u[3 * second[i] + k];
      node[i] = Lanes{a, a, a, a, b, b, b, b};
    }
    for (int i = 0; i < 4; ++i) corner[3 * i + k] = (four_lambda[i] - 1.0) * node[i];
    for (int edge = 0; edge < 6; ++edge) {
      const int a = mesh::kTetEdges[edge][0], b = mesh::kTetEdges[edge][1];
      corner[3 * a + k] += four_lambda[b] * node[4 + edge];
      corner[3 * b + k] += four_lambda[a] * node[4 + edge];
    }
  }
  add_up(corner, gradient, H);
}

/// sym(RᵀH), Mandel.
ARGIL_INLINE void set_turned_strain(const Real33<Lanes>& R, const Real33<Lanes>& H, Lanes* strain) {
  set_turned_tensor(R, H, strain);
  for (int k = 3; k < 6; ++k) strain[k] = kSqrt2 * strain[k];
}

/// Point p, which leaves its frame.
template <int PointsPerTet>
ARGIL_INLINE void replace_frame(const PointArrays& points, const Real33<Lanes>& Q, std::ptrdiff_t p,
                                std::ptrdiff_t lane) {
  points.is_turned[p / PointsPerTet] = 1;
  if (points.changed_frames && points.changed_frames->set(static_cast<std::size_t>(p)))
    std::copy_n(points.frame + 9 * p, 9, points.committed_frame + 9 * p);
  for (int k = 0; k < 9; ++k) points.frame[9 * p + k] = Q.m[k][lane];
}

/// Where F left that of the kept stiffness.
template <int PointsPerTet>
ARGIL_INLINE void replace_deformations(const PointArrays& points, const Real33<Lanes>& F,
                                       std::ptrdiff_t begin, std::ptrdiff_t end) {
  Lanes frame[9], squares = {};
  read_lanes<9>(points.frame, begin, end - 1, frame);
  for (int k = 0; k < 9; ++k) squares += (F.m[k] - frame[k]) * (F.m[k] - frame[k]);
  const Lanes is_changed =
      squares > points.frame_tolerance * points.frame_tolerance ? Lanes{} + 1.0 : Lanes{};
  if (!any(is_changed)) return;
  for (std::ptrdiff_t p = begin; p < end; ++p)
    if (is_changed[p - begin] != 0.0) replace_frame<PointsPerTet>(points, F, p, p - begin);
}

/// Where R left the frame of the turned gradient: another frame, another gradient.
template <int PointsPerTet>
ARGIL_INLINE void turn_frames(const PointArrays& points, const Real33<Lanes>& R, const Lanes* gradient,
                              std::ptrdiff_t begin, std::ptrdiff_t end) {
  Lanes frame[8];
  read_eight<9>(points.frame, begin, end - 1, frame);
  Lanes squares = {};  // of eight entries: the ninth follows from them
  for (int k = 0; k < 8; ++k) squares += (R.m[k] - frame[k]) * (R.m[k] - frame[k]);
  const Lanes is_turned = squares > points.frame_tolerance * points.frame_tolerance ? Lanes{} + 1.0 : Lanes{};
  if (!any(is_turned)) return;
  Lanes turned[12];
  turn(R, gradient, turned);
  for (std::ptrdiff_t p = begin; p < end; ++p) {
    const std::ptrdiff_t lane = p - begin;
    if (is_turned[lane] == 0.0) continue;
    replace_frame<PointsPerTet>(points, R, p, lane);
    for (int k = 0; k < 12; ++k) points.turned_gradient[12 * p + k] = turned[k][lane];
  }
}

template <int PointsPerTet>
ARGIL_INLINE void set_motions(const PointArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end) {
  Lanes gradient[12];
  read_lanes<12>(points.gradient, begin, end - 1, gradient);

  Real33<Lanes> F, R;
  if constexpr (PointsPerTet == 1)
    set_gradient(points.x, points.nodes, gradient, begin, end, F);
  else
    set_quadratic_gradient(points.x, points.nodes, gradient, begin, end, F);
  if (points.is_linear) {
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

  if (points.F) write_lanes<9>(F.m, begin, end, points.F);
  write_lanes<9>(R.m, begin, end, points.R);
  write_lanes<6>(strain, begin, end, points.strain);
  write_lanes<1>(&determinant, begin, end, points.volume_ratio);
  if (points.keeps_deformation)
    replace_deformations<PointsPerTet>(points, F, begin, end);
  else if (points.turned_gradient)
    turn_frames<PointsPerTet>(points, R, gradient, begin, end);
}

}  // namespace

ARGIL_EVERY_PROCESSOR void compute_motions(const PointArrays& points, std::ptrdiff_t begin,
                                           std::ptrdiff_t end) {
  set_motions<1>(points, begin, end);
}

ARGIL_EVERY_PROCESSOR void compute_quadratic_motions(const PointArrays& points, std::ptrdiff_t begin,
                                                     std::ptrdiff_t end) {
  set_motions<4>(points, begin, end);
}

ARGIL_EVERY_PROCESSOR void compute_strains(const StrainArrays& points, std::ptrdiff_t begin,
                                           std::ptrdiff_t end) {
  Lanes gradient[12], strain[6];
  Real33<Lanes> R, H;
  read_lanes<12>(points.gradient, begin, end - 1, gradient);
  read_lanes<9>(points.R, begin, end - 1, R.m);
  set_gradient(points.u, points.nodes, gradient, begin, end, H);
  set_turned_strain(R, H, strain);
  write_lanes<6>(strain, begin, end, points.strain);
}

}  // namespace argil::solid
