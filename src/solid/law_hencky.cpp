// Hencky's law of large strain, elastic and isotropic [Hencky1928; Simo1998]: with the logarithmic strain
// ε = ln U of F = R U,
//   W = μ‖dev ε‖² + ½K (tr ε)²,  Kirchhoff stress τ = 2μ dev ε + K tr ε 1,  P = τ F⁻ᵀ,  K = λ + ⅔μ
// In the principal stretches sᵢ of U = N diag(sᵢ) Nᵀ: εᵢ = ln sᵢ and P = R N diag(τᵢ/sᵢ) Nᵀ.
// Where det F ≤ 0 there is no such strain: W is infinite, P and ∂P/∂F are NaN. The law has no plastic flow.

#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>

#include "base/check.h"
#include "solid/law.h"
#include "solid/polar.h"

namespace argil::solid {
namespace {

/// U = N diag(1 + excess) Nᵀ. The excess sᵢ − 1 keeps the digits of small strains.
struct PrincipalStrain {
  Vec3 excess;
  Mat3 N;
  Vec3 logarithm;  ///< εᵢ = ln sᵢ, ascending

  bool is_inverted() const { return !(excess(0) > -1.0); }
};

PrincipalStrain find_principal_strain(const PointMotion& m, const Vec6& plastic_strain) {
  ARGIL_ASSERT((plastic_strain.array() == 0.0).all());
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(from_mandel(compute_strain(m.F, m.R)));
  PrincipalStrain strain{modes.eigenvalues(), modes.eigenvectors(), Vec3::Zero()};
  for (int i = 0; i < 3; ++i) strain.logarithm(i) = std::log1p(strain.excess(i));
  return strain;
}

/// τᵢ = 2μ εᵢ + λ tr ε, and what the mean volume change around adds [Pa].
Vec3 compute_kirchhoff_stress(const Vec3& logarithm, const Elasticity& e) {
  const double pressure = e.lambda * logarithm.sum() + e.excess_bulk * e.volume_change;
  return 2.0 * e.mu * logarithm + Vec3::Constant(pressure);
}

double compute_hencky_energy(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const PrincipalStrain strain = find_principal_strain(m, plastic_strain);
  if (strain.is_inverted()) return std::numeric_limits<double>::infinity();
  const double trace = strain.logarithm.sum();
  const double bulk = e.lambda + 2.0 / 3.0 * e.mu;
  const Vec3 deviator = strain.logarithm - Vec3::Constant(trace / 3.0);
  return e.mu * deviator.squaredNorm() + 0.5 * bulk * trace * trace;
}

Mat3 compute_hencky_piola(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const PrincipalStrain strain = find_principal_strain(m, plastic_strain);
  if (strain.is_inverted()) return Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vec3 stress =
      compute_kirchhoff_stress(strain.logarithm, e).cwiseQuotient(Vec3::Ones() + strain.excess);
  return m.R * strain.N * stress.asDiagonal() * strain.N.transpose();
}

/// (ln a − ln b)/(a − b) of two stretches with a − b = `difference`; 1/b where they are equal. log1p(y)/y is
/// exact to rounding for every y ≠ 0, so that stretches need not be told apart.
double compute_slope_of_logarithm(double difference, double b) {
  const double y = difference / b;
  return (y == 0.0 ? 1.0 : std::log1p(y) / y) / b;
}

/// ∂P/∂F between the principal directions, where P = diag(Tᵢ) with Tᵢ = τᵢ/sᵢ, and F = diag(sᵢ).
struct PrincipalTangent {
  Mat3 normal;  ///< ∂Tᵢ/∂sⱼ
  Mat3 shear;   ///< (Tᵢ − Tⱼ)/(sᵢ − sⱼ): of a change of shape in the plane i, j
  Mat3 spin;    ///< (Tᵢ + Tⱼ)/(sᵢ + sⱼ): of a rotation in the plane i, j

  /// dP of dF. Off the diagonal, the symmetric part of dF changes the shape and the other one turns the body.
  Mat3 apply(const Mat3& dF) const {
    Mat3 dP = 0.5 * (shear.cwiseProduct(dF + dF.transpose()) + spin.cwiseProduct(dF - dF.transpose()));
    dP.diagonal() = normal * dF.diagonal();
    return dP;
  }
};

/// With m = ½(sᵢ + sⱼ): (Tᵢ − Tⱼ)/(sᵢ − sⱼ) = (2μ m (εᵢ − εⱼ)/(sᵢ − sⱼ) − ½(τᵢ + τⱼ))/(sᵢ sⱼ), which has no
/// difference of nearly equal numbers.
PrincipalTangent compute_principal_tangent(const PrincipalStrain& strain, const Elasticity& e) {
  const Vec3 s = Vec3::Ones() + strain.excess;
  const Vec3 tau = compute_kirchhoff_stress(strain.logarithm, e);
  PrincipalTangent tangent{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const double product = s(i) * s(j);
      tangent.normal(i, j) = tangent.normal(j, i) = e.lambda / product;
      const double slope = compute_slope_of_logarithm(strain.excess(i) - strain.excess(j), s(j));
      tangent.shear(i, j) = tangent.shear(j, i) =
          (e.mu * (s(i) + s(j)) * slope - 0.5 * (tau(i) + tau(j))) / product;
      tangent.spin(i, j) = tangent.spin(j, i) = (tau(i) / s(i) + tau(j) / s(j)) / (s(i) + s(j));
    }
  for (int i = 0; i < 3; ++i) tangent.normal(i, i) += (2.0 * e.mu - tau(i)) / (s(i) * s(i));
  return tangent;
}

Mat9 compute_hencky_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const PrincipalStrain strain = find_principal_strain(m, plastic_strain);
  if (strain.is_inverted()) return Mat9::Constant(std::numeric_limits<double>::quiet_NaN());
  const PrincipalTangent tangent = compute_principal_tangent(strain, e);
  const Mat3 turned = m.R * strain.N;
  Mat9 A;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const Mat3 dF = turned.row(row).transpose() * strain.N.row(column);
      A.col(3 * column + row) = (turned * tangent.apply(dF) * strain.N.transpose()).reshaped();
    }
  return 0.5 * (A + A.transpose());  // which it is but for rounding
}

/// θ = tr ε = ln det F, so that a uniform θ has the energy ½K θ² of the law; ∂θ/∂F = F⁻ᵀ.
double compute_hencky_volume_change(const PointMotion& m, const Vec6& plastic_strain) {
  return find_principal_strain(m, plastic_strain).logarithm.sum();
}

Mat3 compute_hencky_volume_gradient(const PointMotion& m, const Vec6& /*plastic_strain*/) {
  return compute_cofactor(m.F) / m.F.determinant();
}

}  // namespace

constexpr ElasticLaw kHenckyLaw{
    .name = "hencky",
    .about = "large strain, linear in the logarithmic strain, without plastic flow",
    .summary = "strain: large (logarithmic, Hencky)",
    .is_simplified = false,
    .is_linear = false,
    .is_quadratic = false,
    .takes_full_stiffness = false,
    .bears_inversion = false,
    .has_cancelling_energy = false,
    .plastic_split = PlasticSplit::none,
    .energy_density = compute_hencky_energy,
    .piola = compute_hencky_piola,
    .tangent = compute_hencky_tangent,
    .flow_drive = nullptr,
    .volume_change = compute_hencky_volume_change,
    .volume_gradient = compute_hencky_volume_gradient,
};

}  // namespace argil::solid
