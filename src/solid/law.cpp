#include "solid/law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

#include "material/plasticity.h"
#include "solid/polar.h"

namespace argil::solid {
namespace {

using Vec9 = Eigen::Matrix<double, 9, 1>;

Mat3 compute_symmetric_part(const Mat3& a) {
  return 0.5 * (a + a.transpose());
}

Vec6 compute_elastic_strain(const PointMotion& m, const Vec6& plastic_strain) {
  return compute_strain(m.F, m.R) - plastic_strain;
}

bool has_own_rotation(StrainModel model) {
  return model == StrainModel::corotational;
}

/// Inverse of the plastic stretch of the multiplicative split: 1 + ε_p, scaled so that it has the volume
/// exp(tr ε_p). Flow that keeps the volume does so at any strain then; else, in nearly incompressible clay,
/// it would create energy.
Mat3 compute_inverse_plastic_stretch(const Vec6& plastic_strain) {
  const Mat3 stretch = Mat3::Identity() + from_mandel(plastic_strain);
  const double volume = std::exp(plastic_strain.head<3>().sum());
  return std::cbrt(stretch.determinant() / volume) * stretch.inverse();
}

/// P of the neo-Hookean law at Fₑ, before the plastic pull-back.
Mat3 compute_neo_hookean_piola(const Mat3& F, const Elasticity& e) {
  const double pressure = (e.lambda + e.mu) * (F.determinant() - 1.0) - e.mu;
  return e.mu * F + (pressure + e.excess_bulk * e.volume_change) * compute_cofactor(F);
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

Mat9 compute_neo_hookean_tangent(const Mat3& F, const Mat3& inverse_plastic, const Elasticity& e) {
  const Mat3 Fe = F * inverse_plastic;
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

/// G = tr(S) 1 − S, by which a rotation of F resists being changed: Ω = [G⁻¹ axial(RᵀdF)]×.
Mat3 compute_inverse_inertia(const Mat3& S) {
  return (S.trace() * Mat3::Identity() - S).inverse();
}

/// Does the rotation's own derivative enter the stress? Where σ and S always commute it has no part in it.
bool has_spin(StrainModel model, const Vec6& plastic_strain, const Elasticity& e) {
  return has_own_rotation(model) && (e.C || (plastic_strain.array() != 0.0).any());
}

/// w = G⁻¹ k with [k]× = skew(σS): σ:dS with dS = RᵀdF − ΩS is (σ − 2[w]×):RᵀdF.
Vec3 compute_spin(const Mat3& sigma, const Mat3& S, const Mat3& G_inverse) {
  return G_inverse * (0.5 * compute_axial(sigma * S));
}

/// P = R T, T = σ − 2[w]×: dP = R (Ω T + dσ − 2[dw]×), dσ = C:dS, G dw = d(½ axial(σS)) − dG w.
Mat9 compute_corotational_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const bool spins = has_spin(StrainModel::corotational, plastic_strain, e);
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

Mat9 compute_linear_tangent(const Elasticity& e) {
  Mat9 A;
  for (int k = 0; k < 9; ++k) {
    Mat3 dF = Mat3::Zero();
    dF(k) = 1.0;
    A.col(k) = from_mandel(compute_stress(e, to_mandel(compute_symmetric_part(dF)))).reshaped();
  }
  return A;
}

}  // namespace

PointMotion make_motion(StrainModel model, const Mat3& F) {
  return {F, model == StrainModel::linear ? Mat3(Mat3::Identity()) : compute_rotation(F)};
}

Vec6 compute_strain(const Mat3& F, const Mat3& R) {
  return to_mandel(compute_symmetric_part(R.transpose() * F) - Mat3::Identity());
}

Mat6 make_isotropic_stiffness(double lambda, double mu) {
  Mat6 C = 2.0 * mu * Mat6::Identity();
  C.topLeftCorner<3, 3>().array() += lambda;
  return C;
}

Vec6 compute_stress(const Elasticity& e, const Vec6& elastic_strain) {
  if (e.C) return *e.C * elastic_strain;
  Vec6 sigma = 2.0 * e.mu * elastic_strain;
  sigma.head<3>().array() += e.lambda * elastic_strain.head<3>().sum();
  return sigma;
}

double compute_energy_density(StrainModel model, const PointMotion& m, const Vec6& plastic_strain,
                              const Elasticity& e) {
  if (model != StrainModel::neo_hookean) {
    const Vec6 elastic = compute_elastic_strain(m, plastic_strain);
    return 0.5 * elastic.dot(compute_stress(e, elastic));
  }
  const Mat3 Fe = m.F * compute_inverse_plastic_stretch(plastic_strain);
  const double change = Fe.determinant() - 1.0;
  // ½μ(tr FₑᵀFₑ − 3) in the displacement gradient H = Fₑ − 1, so that small strains keep their digits.
  const Mat3 H = Fe - Mat3::Identity();
  const double stretch = H.trace() + 0.5 * H.squaredNorm();
  return e.mu * (stretch - change) + 0.5 * (e.lambda + e.mu) * change * change;
}

Mat3 compute_piola(StrainModel model, const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  if (model == StrainModel::neo_hookean) {
    if (!(plastic_strain.array() != 0.0).any()) return compute_neo_hookean_piola(m.F, e);
    const Mat3 inverse = compute_inverse_plastic_stretch(plastic_strain);
    return compute_neo_hookean_piola(m.F * inverse, e) * inverse.transpose();
  }
  Mat3 sigma = from_mandel(compute_stress(e, compute_elastic_strain(m, plastic_strain)));
  if (has_spin(model, plastic_strain, e)) {
    const Mat3 S = compute_symmetric_part(m.R.transpose() * m.F);
    sigma -= 2.0 * make_cross_matrix(compute_spin(sigma, S, compute_inverse_inertia(S)));
  }
  sigma.diagonal().array() += e.excess_bulk * e.volume_change;
  return m.R * sigma;
}

Mat9 compute_tangent(StrainModel model, const PointMotion& m, const Vec6& plastic_strain,
                     const Elasticity& e) {
  switch (model) {
    case StrainModel::linear:
      return compute_linear_tangent(e);
    case StrainModel::corotational:
      return compute_corotational_tangent(m, plastic_strain, e);
    case StrainModel::neo_hookean:
      break;
  }
  return compute_neo_hookean_tangent(m.F, compute_inverse_plastic_stretch(plastic_strain), e);
}

Mat9 make_positive(const Mat9& A) {
  // A small multiple of the identity lets semi-definite matrices, which are fine, pass the quick test.
  const Mat9 shifted = A + 1e-9 * A.diagonal().cwiseAbs().maxCoeff() * Mat9::Identity();
  if (shifted.llt().info() == Eigen::Success) return A;
  const Eigen::SelfAdjointEigenSolver<Mat9> modes(A);
  return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).asDiagonal() *
         modes.eigenvectors().transpose();
}

Vec6 compute_flow_drive(StrainModel model, const PointMotion& m, const Vec6& plastic_strain,
                        const Elasticity& e, double shape_stiffness) {
  if (model != StrainModel::neo_hookean)
    return material::compute_stress_drive(compute_stress(e, compute_elastic_strain(m, plastic_strain)),
                                          shape_stiffness);
  const Mat3 Fe = m.F * compute_inverse_plastic_stretch(plastic_strain);
  Mat3 M = compute_symmetric_part(Fe.transpose() * compute_neo_hookean_piola(Fe, e));
  M.diagonal().array() -= M.trace() / 3.0;
  const Mat3 stretch = Mat3::Identity() + from_mandel(plastic_strain);
  return material::compute_stress_drive(to_mandel(compute_symmetric_part(M * stretch.inverse())),
                                        shape_stiffness);
}

double compute_volume_change(StrainModel model, const PointMotion& m, const Vec6& plastic_strain) {
  if (model != StrainModel::neo_hookean) return compute_elastic_strain(m, plastic_strain).head<3>().sum();
  return (m.F * compute_inverse_plastic_stretch(plastic_strain)).determinant() - 1.0;
}

Mat3 compute_volume_gradient(StrainModel model, const PointMotion& m, const Vec6& plastic_strain) {
  if (model != StrainModel::neo_hookean) return m.R;
  const Mat3 inverse = compute_inverse_plastic_stretch(plastic_strain);
  return compute_cofactor(m.F * inverse) * inverse.transpose();
}

}  // namespace argil::solid
