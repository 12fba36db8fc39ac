// The stable neo-Hookean law of large strain, isotropic [Smith2018, without the logarithm]:
//   W = ½μ(tr FₑᵀFₑ − 3) − μ(J − 1) + ½(λ + μ)(J − 1)²,  J = det Fₑ,  Fₑ = F F_p⁻¹
// F_p = 1 + ε_p, scaled to det F_p = exp(tr ε_p). W, P and ∂P/∂F are finite for every F, also where det F ≤
// 0.

#include <Eigen/LU>

#include <cmath>

#include "material/plasticity.h"
#include "solid/law.h"
#include "solid/polar.h"

namespace argil::solid {
namespace {

using Vec9 = Eigen::Matrix<double, 9, 1>;

/// Inverse of the plastic stretch of the multiplicative split: 1 + ε_p, scaled so that it has the volume
/// exp(tr ε_p). Flow that keeps the volume does so at any strain then; else, in nearly incompressible clay,
/// it would create energy.
Mat3 compute_inverse_plastic_stretch(const Vec6& plastic_strain) {
  const Mat3 stretch = Mat3::Identity() + from_mandel(plastic_strain);
  const double volume = std::exp(plastic_strain.head<3>().sum());
  return std::cbrt(stretch.determinant() / volume) * stretch.inverse();
}

double compute_neo_hookean_energy(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const Mat3 Fe = m.F * compute_inverse_plastic_stretch(plastic_strain);
  const double change = Fe.determinant() - 1.0;
  // ½μ(tr FₑᵀFₑ − 3) in the displacement gradient H = Fₑ − 1, so that small strains keep their digits.
  const Mat3 H = Fe - Mat3::Identity();
  const double stretch = H.trace() + 0.5 * H.squaredNorm();
  return e.mu * (stretch - change) + 0.5 * (e.lambda + e.mu) * change * change;
}

/// ∂W/∂Fₑ, before the plastic pull-back.
Mat3 compute_elastic_piola(const Mat3& Fe, const Elasticity& e) {
  const double pressure = (e.lambda + e.mu) * (Fe.determinant() - 1.0) - e.mu;
  return e.mu * Fe + (pressure + e.excess_bulk * e.volume_change) * compute_cofactor(Fe);
}

Mat3 compute_neo_hookean_piola(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  if (!(plastic_strain.array() != 0.0).any()) return compute_elastic_piola(m.F, e);
  const Mat3 inverse = compute_inverse_plastic_stretch(plastic_strain);
  return compute_elastic_piola(m.F * inverse, e) * inverse.transpose();
}

/// ∂cof F/∂F times `scale`, added to A: cof F is quadratic, so its derivative along a unit matrix is exact
/// from two values.
void add_cofactor_derivative(const Mat3& F, double scale, Mat9& A) {
  for (int k = 0; k < 9; ++k) {
    Mat3 plus = F;
    Mat3 minus = F;
    plus(k) += 1.0;
    minus(k) -= 1.0;
    A.col(k) += 0.5 * scale * (compute_cofactor(plus) - compute_cofactor(minus)).reshaped();
  }
}

Mat9 compute_neo_hookean_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const Mat3 inverse_plastic = compute_inverse_plastic_stretch(plastic_strain);
  const Mat3 Fe = m.F * inverse_plastic;
  const Vec9 cofactor = compute_cofactor(Fe).reshaped();
  const double bulk = e.lambda + e.mu;
  Mat9 A = e.mu * Mat9::Identity() + bulk * cofactor * cofactor.transpose();
  const double pressure = bulk * (Fe.determinant() - 1.0) - e.mu + e.excess_bulk * e.volume_change;
  add_cofactor_derivative(Fe, pressure, A);
  if (inverse_plastic.isIdentity(0.0)) return A;
  Mat9 pull = Mat9::Zero();  // vec(dF Fp⁻¹) = (Fp⁻ᵀ ⊗ 1) vec(dF)
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) pull.block<3, 3>(3 * i, 3 * j) = inverse_plastic(j, i) * Mat3::Identity();
  return pull.transpose() * A * pull;
}

/// With the Mandel stress M = Fₑᵀ ∂W/∂Fₑ, −∂W/∂ε_p = sym(dev M (1 + ε_p)⁻¹) for a change without trace.
Vec6 compute_neo_hookean_drive(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e,
                               double shape_stiffness) {
  const Mat3 Fe = m.F * compute_inverse_plastic_stretch(plastic_strain);
  Mat3 M = compute_symmetric_part(Fe.transpose() * compute_elastic_piola(Fe, e));
  M.diagonal().array() -= M.trace() / 3.0;
  const Mat3 stretch = Mat3::Identity() + from_mandel(plastic_strain);
  return material::compute_stress_drive(to_mandel(compute_symmetric_part(M * stretch.inverse())),
                                        shape_stiffness);
}

/// θ = det Fₑ − 1.
double compute_neo_hookean_volume_change(const PointMotion& m, const Vec6& plastic_strain) {
  return (m.F * compute_inverse_plastic_stretch(plastic_strain)).determinant() - 1.0;
}

Mat3 compute_neo_hookean_volume_gradient(const PointMotion& m, const Vec6& plastic_strain) {
  const Mat3 inverse = compute_inverse_plastic_stretch(plastic_strain);
  return compute_cofactor(m.F * inverse) * inverse.transpose();
}

}  // namespace

constexpr ElasticLaw kNeoHookeanLaw{
    .name = "neo_hookean",
    .about = "a reference for large strain",
    .summary = "strain: large (neo-Hookean)",
    .is_simplified = false,
    .is_linear = false,
    .is_quadratic = false,
    .takes_full_stiffness = false,
    .bears_inversion = true,
    .has_cancelling_energy = true,
    .plastic_split = PlasticSplit::multiplicative,
    .energy_density = compute_neo_hookean_energy,
    .piola = compute_neo_hookean_piola,
    .tangent = compute_neo_hookean_tangent,
    .flow_drive = compute_neo_hookean_drive,
    .volume_change = compute_neo_hookean_volume_change,
    .volume_gradient = compute_neo_hookean_volume_gradient,
    .flow = nullptr,
    .positive_tangent = nullptr,
    .lanes = {},
};

}  // namespace argil::solid
