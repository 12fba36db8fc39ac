#pragma once

#include "mesh/topology.h"
#include "water/parameters.h"

namespace argil::water {

/// What diffusion needs to know of a mesh; made once. Entry (corner, t) belongs to the face of tet t opposite
/// to that corner; at the boundary, which is sealed, it is zero. Flow into t across a face, divided by ρ_w n:
///   D A n·∇S ≈ (D A/d_n) (S_o − S_t) + D A (n − d/d_n)·∇S,   d = c_o − c_t, d_n = d·n,
/// n the unit normal from t to its neighbour o, c centroids. The first term is the two-point flux; the
/// second, zero where d ∥ n, makes a linear S flow exactly. Both sides of a face hold the same bits, but for
/// the sign.
struct Stencil {
  Tets neighbours;                                    ///< 4×m: tet across each face or −1
  Eigen::Matrix4Xd conductance;                       ///< D A/d_n [m³/s]
  Eigen::Matrix<double, 12, Eigen::Dynamic> tangent;  ///< D A (n − d/d_n) [m⁴/s], three entries a corner
  Eigen::Matrix<double, 12, Eigen::Dynamic> gradient;  ///< ∇S = Σ gradient (S_o − S_t) [1/m], three a corner
  Field volume;                                        ///< of each tet at rest [m³]
  Field
      wall_distance;  ///< of a tet's centroid from its boundary faces, or from a mean face if it has none [m]
  double monotone_step = 0.0;  ///< min V_t/Σ conductance [s]: longest explicit step with a maximum principle
};

/// Saturation [–]: two tets that both hold less pass nothing. Else an explicit scheme would wet one layer of
/// tets a substep with saturations like 1e-100, and a local touch would cost as much as the whole body. What
/// is held back is not lost: it stays where it is, and is booked.
inline constexpr double kTrace = 1e-12;

/// Row where the three entries of a corner begin.
inline Eigen::Index row_of(int corner) {
  return Eigen::Index{3} * corner;
}

/// `tangent` and `gradient` stay empty for FluxForm::two_point. Tets must have positive volume (asserted).
Stencil make_stencil(const mesh::TetMesh& mesh, const mesh::Topology& topology, double diffusivity,
                     FluxForm form);

}  // namespace argil::water
