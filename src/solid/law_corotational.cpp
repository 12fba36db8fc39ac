// Small strain in the frame of the polar decomposition F = R S: W = ½ ε_e:C:ε_e, ε_e = S − 1 − ε_p. A turn is
// free.

#include <Eigen/LU>

#include "solid/law_quadratic.h"
#include "solid/polar.h"
#include "solid/tet_lanes.h"

namespace argil::solid {
namespace {

/// G = tr(S) 1 − S, by which a rotation of F resists being changed: Ω = [G⁻¹ axial(RᵀdF)]×.
Mat3 compute_inverse_inertia(const Mat3& S) {
  return (S.trace() * Mat3::Identity() - S).inverse();
}

/// Does the rotation's own derivative enter the stress? Where σ and S always commute it has no part in it.
bool has_spin(const Vec6& plastic_strain, const Elasticity& e) {
  return e.C || (plastic_strain.array() != 0.0).any();
}

/// w = G⁻¹ k with [k]× = skew(σS): σ:dS with dS = RᵀdF − ΩS is (σ − 2[w]×):RᵀdF.
Vec3 compute_spin(const Mat3& sigma, const Mat3& S, const Mat3& G_inverse) {
  return G_inverse * (0.5 * compute_axial(sigma * S));
}

/// P = R (σ − 2[w]×).
Mat3 compute_corotational_piola(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  Mat3 sigma = from_mandel(compute_stress(e, compute_elastic_strain(m, plastic_strain)));
  if (has_spin(plastic_strain, e)) {
    const Mat3 S = compute_symmetric_part(m.R.transpose() * m.F);
    sigma -= 2.0 * make_cross_matrix(compute_spin(sigma, S, compute_inverse_inertia(S)));
  }
  sigma.diagonal().array() += e.excess_bulk * e.volume_change;
  return m.R * sigma;
}

/// P = R T, T = σ − 2[w]×: dP = R (Ω T + dσ − 2[dw]×), dσ = C:dS, G dw = d(½ axial(σS)) − dG w.
Mat9 compute_corotational_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const bool spins = has_spin(plastic_strain, e);
  const Mat3 S = compute_symmetric_part(m.R.transpose() * m.F);
  const Mat3 G_inverse = compute_inverse_inertia(S);
  const Mat3 sigma = from_mandel(compute_stress(e, compute_elastic_strain(m, plastic_strain)));
  const Vec3 w = spins ? compute_spin(sigma, S, G_inverse) : Vec3(Vec3::Zero());
  const Mat3 T = sigma + e.excess_bulk * e.volume_change * Mat3::Identity() - 2.0 * make_cross_matrix(w);
  Mat9 A;
  for (int k = 0; k < 9; ++k) {
    Mat3 dF = Mat3::Zero();
    dF(k) = 1.0;
    const Mat3 turned = m.R.transpose() * dF;
    const Mat3 omega = make_cross_matrix(G_inverse * compute_axial(turned));
    const Mat3 dS = compute_symmetric_part(turned - omega * S);
    const Mat3 dsigma = from_mandel(compute_stress(e, to_mandel(dS)));
    Mat3 change = omega * T + dsigma;
    if (spins) {
      const Vec3 dw = G_inverse * (0.5 * compute_axial(dsigma * S + sigma * dS) - dS.trace() * w + dS * w);
      change -= 2.0 * make_cross_matrix(dw);
    }
    A.col(k) = (m.R * change).reshaped();
  }
  return 0.5 * (A + A.transpose());  // which it is but for rounding
}

}  // namespace

constexpr ElasticLaw kCorotationalLaw{
    .name = "corotational",
    .about = "small strain in each tet, which may turn",
    .summary = "strain: small in each tet, which turns (corotational): not for large strain",
    .is_simplified = true,
    .is_linear = false,
    .is_quadratic = true,
    .takes_full_stiffness = true,
    .bears_inversion = true,
    .has_cancelling_energy = false,
    .plastic_split = PlasticSplit::additive,
    .energy_density = compute_quadratic_energy,
    .piola = compute_corotational_piola,
    .tangent = compute_corotational_tangent,
    .flow_drive = compute_quadratic_drive,
    .volume_change = compute_trace,
    .volume_gradient = compute_trace_gradient,
    .flow = nullptr,
    .positive_tangent = nullptr,
    .lanes = {compute_corner_forces, compute_energy, compute_kept_stiffness},
};

}  // namespace argil::solid
