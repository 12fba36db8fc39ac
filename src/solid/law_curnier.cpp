// Curnier's law of large strain, elastic and isotropic: F = R S,
//   W = μ E:E + ½ λ θ²,  E = ¼ (S^(5/2) − S^(−3/2)),  θ = ¼ (J^(5/2) − J^(−3/2)),  J = det F
// E is the strain (U^m − U^−n)/(m + n) of [Curnier1991] with m = n + 1, for which W is quadratic in S − 1 to
// third order: nominal stress stays linear as far as it can, then rises without bound in tension and
// compression. With n = 3/2 P is rational in S. Where det F ≤ 0 there is no such strain: W is infinite, P and
// ∂P/∂F are NaN.

#include <array>
#include <limits>

#include "solid/curnier_lanes.h"
#include "solid/curnier_point.h"
#include "solid/law.h"
#include "solid/polar.h"

namespace argil::solid {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Tensor = std::array<double, 6>;  // 11 22 33 23 13 12

Tensor find_strain(const PointMotion& m) {
  return make_tensor(compute_strain(m.F, m.R));
}

bool is_inverted(const PointMotion& m) {
  return !(m.F.determinant() > 0.0);
}

double compute_energy_of(const PointMotion& m, const Vec6& /*plastic_strain*/, const Elasticity& e) {
  if (is_inverted(m)) return std::numeric_limits<double>::infinity();
  double energy;
  set_curnier_energy(find_strain(m).data(), e.lambda, e.mu, energy);
  return energy;
}

Mat3 compute_piola_of(const PointMotion& m, const Vec6& /*plastic_strain*/, const Elasticity& e) {
  if (is_inverted(m)) return Mat3::Constant(kNaN);
  Tensor t;
  set_curnier_stress(find_strain(m).data(), e.lambda, e.mu, e.excess_bulk * e.volume_change, t.data());
  Mat3 biot;
  biot << t[0], t[5], t[4], t[5], t[1], t[3], t[4], t[3], t[2];
  return m.R * biot;
}

Mat9 compute_tangent_of(const PointMotion& m, const Elasticity& e, bool is_positive) {
  if (is_inverted(m)) return Mat9::Constant(kNaN);
  Real33<double> modes;
  double trace;
  PrincipalTangent<double> tangent;
  find_curnier_tangent(find_strain(m).data(), e.lambda, e.mu, e.excess_bulk * e.volume_change, modes, trace,
                       tangent);
  if (is_positive) make_positive(e.mu, tangent);
  const Mat3 directions = m.R * Eigen::Map<const Mat3>(modes.m);
  return make_tangent(tangent, trace, directions, m.F.inverse() * directions);
}

Mat9 compute_tangent(const PointMotion& m, const Vec6& /*plastic_strain*/, const Elasticity& e) {
  return compute_tangent_of(m, e, false);
}

Mat9 compute_positive_tangent(const PointMotion& m, const Vec6& /*plastic_strain*/, const Elasticity& e) {
  return compute_tangent_of(m, e, true);
}

CurnierVolume<double> find_volume(const PointMotion& m) {
  CurnierVolume<double> volume;
  find_curnier_volume(find_strain(m).data(), volume);
  return volume;
}

double compute_volume_change_of(const PointMotion& m, const Vec6& /*plastic_strain*/) {
  return find_volume(m).change;
}

Mat3 compute_volume_gradient_of(const PointMotion& m, const Vec6& /*plastic_strain*/) {
  return find_volume(m).rise / m.F.determinant() * compute_cofactor(m.F);
}

}  // namespace

constexpr ElasticLaw kCurnierLaw{
    .name = "curnier",
    .about =
        "large strain, elastic, linear in the nominal stress as far as it can be, and no tet turns inside "
        "out",
    .summary = "strain: large (generalised, Curnier)",
    .is_simplified = false,
    .is_linear = false,
    .is_quadratic = false,
    .takes_full_stiffness = false,
    .bears_inversion = false,
    .has_cancelling_energy = false,
    .plastic_split = PlasticSplit::none,
    .energy_density = compute_energy_of,
    .piola = compute_piola_of,
    .tangent = compute_tangent,
    .flow_drive = nullptr,
    .volume_change = compute_volume_change_of,
    .volume_gradient = compute_volume_gradient_of,
    .flow = nullptr,
    .positive_tangent = compute_positive_tangent,
    .lanes = {compute_curnier_forces, compute_curnier_energy, compute_curnier_stiffness},
};

}  // namespace argil::solid
