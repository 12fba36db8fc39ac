// Hencky's law of large strain, isotropic [Hencky1928; Simo1998]: F = Fₑ F_p, with the elastic strain ε = ½
// ln FₑFₑᵀ
//   W = μ‖dev ε‖² + ½K (tr ε)²,  Kirchhoff stress τ = 2μ dev ε + K tr ε 1,  P = τ F⁻ᵀ,  K = λ + ⅔μ
// The plastic strain is E_p = ½ ln F_pᵀF_p, without trace, so that det F_p = 1, but for what the shape at
// rest has of it. Flow takes a part of dev ε away at held F, and ε keeps its directions: radial return
// [Simo1998]. Where det F ≤ 0 there is no such strain: W is infinite, P and ∂P/∂F are NaN.

#include <Eigen/LU>

#include <cmath>
#include <limits>

#include "solid/hencky_lanes.h"
#include "solid/hencky_point.h"
#include "solid/law.h"
#include "solid/polar.h"

namespace argil::solid {
namespace {

Mat3 make_matrix(const Real33<double>& a) {
  return Eigen::Map<const Mat3>(a.m);
}

struct HenckyPoint {
  ElasticStretch<double> stretch;
  Vec3 logarithm;
  Mat3 N;
  Vec6 strain;  ///< S − 1 of F = R S
  bool is_inverted;

  Mat3 inverse_stretch() const { return (Mat3::Identity() + from_mandel(strain)).inverse(); }  ///< S⁻¹
};

HenckyPoint find_point(const PointMotion& m, const Vec6& plastic_strain) {
  HenckyPoint point;
  point.strain = compute_strain(m.F, m.R);
  point.is_inverted = !(m.F.determinant() > 0.0);
  const auto strain = make_tensor(point.strain);
  const auto plastic = make_tensor(plastic_strain);
  find_elastic_stretch(strain.data(), plastic_strain.isZero(0.0) ? nullptr : plastic.data(), point.stretch);
  point.logarithm = Eigen::Map<const Vec3>(point.stretch.logarithm);
  point.N = make_matrix(point.stretch.N);
  return point;
}

/// τᵢ = 2μ εᵢ + λ tr ε, and what the mean volume change around adds [Pa].
Vec3 compute_kirchhoff_stress(const Vec3& logarithm, const Elasticity& e) {
  const double pressure = e.lambda * logarithm.sum() + e.excess_bulk * e.volume_change;
  return 2.0 * e.mu * logarithm + Vec3::Constant(pressure);
}

double compute_hencky_energy(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const HenckyPoint point = find_point(m, plastic_strain);
  if (point.is_inverted) return std::numeric_limits<double>::infinity();
  const double trace = point.stretch.trace;
  return e.mu * point.logarithm.squaredNorm() + 0.5 * e.lambda * trace * trace;
}

/// P = R τ S⁻¹.
Mat3 compute_hencky_piola(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  const HenckyPoint point = find_point(m, plastic_strain);
  if (point.is_inverted) return Mat3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vec3 tau = compute_kirchhoff_stress(point.logarithm, e);
  return m.R * point.N * tau.asDiagonal() * point.N.transpose() * point.inverse_stretch();
}

Mat9 compute_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e,
                     bool is_positive) {
  const HenckyPoint point = find_point(m, plastic_strain);
  if (point.is_inverted) return Mat9::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vec3 tau = compute_kirchhoff_stress(point.logarithm, e);
  PrincipalTangent<double> tangent;
  set_principal_tangent(point.stretch, e.mu, tau.data(), tangent);
  if (is_positive) make_positive(e.mu, tangent);
  return make_tangent(tangent, e.lambda, m.R * point.N, point.inverse_stretch() * point.N);
}

Mat9 compute_hencky_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  return compute_tangent(m, plastic_strain, e, false);
}

/// In the directions of b the tangent falls into planes.
Mat9 compute_positive_hencky_tangent(const PointMotion& m, const Vec6& plastic_strain, const Elasticity& e) {
  return compute_tangent(m, plastic_strain, e, true);
}

/// θ = tr ε = ln det F, so that a uniform θ has the energy ½K θ² of the law; ∂θ/∂F = F⁻ᵀ.
double compute_hencky_volume_change(const PointMotion& m, const Vec6& plastic_strain) {
  return find_point(m, plastic_strain).stretch.trace;
}

Mat3 compute_hencky_volume_gradient(const PointMotion& m, const Vec6& /*plastic_strain*/) {
  return compute_cofactor(m.F) / m.F.determinant();
}

}  // namespace

constexpr ElasticLaw kHenckyLaw{
    .name = "hencky",
    .about = "large strain, linear in the logarithmic strain, with flow that keeps the volume",
    .summary = "strain: large (logarithmic, Hencky)",
    .is_simplified = false,
    .is_linear = false,
    .is_quadratic = false,
    .takes_full_stiffness = false,
    .bears_inversion = false,
    .has_cancelling_energy = false,
    .plastic_split = PlasticSplit::logarithmic,
    .energy_density = compute_hencky_energy,
    .piola = compute_hencky_piola,
    .tangent = compute_hencky_tangent,
    .flow_drive = nullptr,
    .volume_change = compute_hencky_volume_change,
    .volume_gradient = compute_hencky_volume_gradient,
    .flow = flow_by_hencky,
    .positive_tangent = compute_positive_hencky_tangent,
    .lanes = {compute_hencky_forces, compute_hencky_energy, compute_hencky_stiffness},
};

}  // namespace argil::solid
