#include "material/effective_medium.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "material/eshelby.h"

namespace argil::material {
namespace {

/// Isotropic tensor 3κ J + 2γ K by its two eigenvalues (J: mean part, K: deviator).
struct Isotropic {
  double mean = 0.0;      // eigenvalue on J (3K for a stiffness)
  double deviator = 0.0;  // eigenvalue on K (2G for a stiffness)
};

Mat6 to_matrix(const Isotropic& a) {
  Mat6 m = a.deviator * Mat6::Identity();
  m.topLeftCorner<3, 3>().array() += (a.mean - a.deviator) / 3.0;
  return m;
}

/// Average over all orientations: the isotropic part.
Isotropic average(const Mat6& a) {
  const double mean = a.topLeftCorner<3, 3>().sum() / 3.0;
  return {mean, (a.trace() - mean) / 5.0};
}

Isotropic make_solid(const Elastic& solid) {
  const double E = solid.youngs_modulus;
  const double nu = solid.poissons_ratio;
  return {E / (1.0 - 2.0 * nu), E / (1.0 + nu)};
}

Isotropic make_fluid(const EffectiveMedium& medium) {
  return {3.0 * medium.fluid_bulk_modulus, 2.0 * medium.fluid_shear_modulus};
}

double poissons_ratio_of(const Isotropic& stiffness) {
  const double K = stiffness.mean / 3.0;
  const double G = stiffness.deviator / 2.0;
  return (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G));
}

/// Strain concentration A = (1 − P T)⁻¹ of one inclusion in `matrix`, T = S^M (C^M − C^I). C^M − C^I is never
/// inverted.
Mat6 compute_concentration(const Isotropic& matrix, const Isotropic& fluid, double aspect) {
  const Isotropic T{1.0 - fluid.mean / matrix.mean, 1.0 - fluid.deviator / matrix.deviator};
  const Mat6 P = compute_eshelby_tensor(poissons_ratio_of(matrix), aspect);
  return (Mat6::Identity() - P * to_matrix(T)).inverse();
}

/// Hashin–Shtrikman expression with the reference medium's stiffness [Hashin & Shtrikman 1963].
Isotropic compute_hashin_shtrikman(const Isotropic& solid, const Isotropic& fluid, double phi,
                                   const Isotropic& reference) {
  const double K = reference.mean / 3.0;
  const double G = reference.deviator / 2.0;
  const double bulk_star = 4.0 * G / 3.0;
  const double shear_star = K + 2.0 * G > 0.0 ? G * (9.0 * K + 8.0 * G) / (6.0 * (K + 2.0 * G)) : 0.0;
  const auto mix = [phi](double s, double f, double star) {
    if (f + star == 0.0) return phi > 0.0 ? 0.0 : s;
    return 1.0 / ((1.0 - phi) / (s + star) + phi / (f + star)) - star;
  };
  return {3.0 * mix(solid.mean / 3.0, fluid.mean / 3.0, bulk_star),
          2.0 * mix(solid.deviator / 2.0, fluid.deviator / 2.0, shear_star)};
}

/// C = C^M + φ (C^I − C^M) ⟨A(C)⟩: iterated from the Mori–Tanaka side. Goes to zero past the percolation
/// point.
Isotropic compute_self_consistent(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect) {
  constexpr int kMaxIterations = 20000;
  constexpr double kAgreement = 1e-14;
  Isotropic C = solid;
  const double floor = 1e-12;  // relative stiffness below which the medium counts as fallen apart
  for (int i = 0; i < kMaxIterations; ++i) {
    const Isotropic A = average(compute_concentration(C, fluid, aspect));
    const Isotropic next{solid.mean + phi * (fluid.mean - solid.mean) * A.mean,
                         solid.deviator + phi * (fluid.deviator - solid.deviator) * A.deviator};
    if (!(next.mean > floor * solid.mean && next.deviator > floor * solid.deviator)) return {0.0, 0.0};
    const double change =
        std::abs(next.mean - C.mean) / solid.mean + std::abs(next.deviator - C.deviator) / solid.deviator;
    C = next;
    if (change < kAgreement) break;
  }
  return C;
}

/// dC/dφ = (C^I − C) ⟨A(C)⟩ / (1 − φ) from the dry solid, classical Runge–Kutta.
Isotropic compute_differential(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect) {
  constexpr int kSteps = 64;
  const auto slope = [&](const Isotropic& C, double at) {
    const Isotropic A = average(compute_concentration(C, fluid, aspect));
    return Isotropic{(fluid.mean - C.mean) * A.mean / (1.0 - at),
                     (fluid.deviator - C.deviator) * A.deviator / (1.0 - at)};
  };
  const auto plus = [](const Isotropic& C, double h, const Isotropic& k) {
    return Isotropic{C.mean + h * k.mean, C.deviator + h * k.deviator};
  };
  Isotropic C = solid;
  const double h = phi / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double at = i * h;
    const Isotropic k1 = slope(C, at);
    const Isotropic k2 = slope(plus(C, 0.5 * h, k1), at + 0.5 * h);
    const Isotropic k3 = slope(plus(C, 0.5 * h, k2), at + 0.5 * h);
    const Isotropic k4 = slope(plus(C, h, k3), at + h);
    C.mean += h / 6.0 * (k1.mean + 2.0 * k2.mean + 2.0 * k3.mean + k4.mean);
    C.deviator += h / 6.0 * (k1.deviator + 2.0 * k2.deviator + 2.0 * k3.deviator + k4.deviator);
  }
  return C;
}

Mat6 compute_stiffness(const Elastic& elastic, const EffectiveMedium& medium, double phi) {
  const Isotropic solid = make_solid(elastic);
  const Isotropic fluid = make_fluid(medium);
  const Mat6 C_M = to_matrix(solid);
  const Mat6 one = Mat6::Identity();
  const bool random = medium.orientation == Orientation::random;
  const auto oriented = [random](const Mat6& a) { return random ? to_matrix(average(a)) : a; };
  const auto concentration = [&] { return compute_concentration(solid, fluid, medium.aspect); };
  const Mat6 T = to_matrix({1.0 - fluid.mean / solid.mean, 1.0 - fluid.deviator / solid.deviator});
  const auto harmonic = [phi](double s, double f) {
    return f > 0.0 ? 1.0 / ((1.0 - phi) / s + phi / f) : (phi > 0.0 ? 0.0 : s);
  };
  switch (medium.scheme) {
    case Scheme::dilute:  // eq. 6: S = [1 + φ T A] S^M
      return C_M * (one + phi * oriented(T * concentration())).inverse();
    case Scheme::dilute_strain:  // C = C^M [1 − φ T A]
      return C_M * (one - phi * oriented(T * concentration()));
    case Scheme::mori_tanaka: {  // C = C^M [1 − φ T⟨A⟩ ((1−φ) + φ⟨A⟩)⁻¹]  [Mori1973]
      const Mat6 A = oriented(concentration());
      return C_M * (one - phi * T * A * ((1.0 - phi) * one + phi * A).inverse());
    }
    case Scheme::self_consistent:
      return to_matrix(compute_self_consistent(solid, fluid, phi, medium.aspect));
    case Scheme::differential:
      return to_matrix(compute_differential(solid, fluid, phi, medium.aspect));
    case Scheme::voigt:  // eq. 3
      return (1.0 - phi) * C_M + phi * to_matrix(fluid);
    case Scheme::reuss:  // eq. 4
      return to_matrix({harmonic(solid.mean, fluid.mean), harmonic(solid.deviator, fluid.deviator)});
    case Scheme::hs_lower:
    case Scheme::hs_upper: {
      const bool lower = medium.scheme == Scheme::hs_lower;
      const auto pick = [lower](double a, double b) { return lower ? std::min(a, b) : std::max(a, b); };
      return to_matrix(compute_hashin_shtrikman(
          solid, fluid, phi, {pick(solid.mean, fluid.mean), pick(solid.deviator, fluid.deviator)}));
    }
  }
  return C_M;
}

/// Names where the result left its bounds: "bulk" or "shear" of an isotropic one, else the strongest Mandel
/// component.
std::string name_mode(bool is_isotropic, double bulk_margin, double shear_margin, Eigen::Index direction) {
  if (is_isotropic) return bulk_margin < shear_margin ? "bulk" : "shear";
  return "strain mode " + std::to_string(direction + 1);
}

}  // namespace

bool is_supported(const EffectiveMedium& medium) {
  const bool needs_isotropic_matrix =
      medium.scheme == Scheme::self_consistent || medium.scheme == Scheme::differential;
  return !(needs_isotropic_matrix && medium.orientation == Orientation::aligned && medium.aspect != 1.0);
}

MediumResult compute_effective_medium(const Elastic& solid, const EffectiveMedium& medium, double phi) {
  ARGIL_ASSERT(is_supported(medium));
  MediumResult result;
  result.stiffness = compute_stiffness(solid, medium, phi);
  result.stiffness = (0.5 * (result.stiffness + result.stiffness.transpose())).eval();
  const Isotropic iso = average(result.stiffness);
  result.bulk_modulus = iso.mean / 3.0;
  result.shear_modulus = iso.deviator / 2.0;

  const Isotropic dry = make_solid(solid);
  const Isotropic fluid = make_fluid(medium);
  const Mat6 voigt = (1.0 - phi) * to_matrix(dry) + phi * to_matrix(fluid);
  const bool is_isotropic = medium.aspect == 1.0 || medium.orientation == Orientation::random;
  constexpr double kRounding = 1e-12;
  const double scale = std::max(dry.mean, dry.deviator);
  const Eigen::SelfAdjointEigenSolver<Mat6> own(result.stiffness);
  const Eigen::SelfAdjointEigenSolver<Mat6> below(voigt - result.stiffness);
  if (!(own.eigenvalues()(0) > 0.0)) {
    result.status = MediumStatus::not_positive_definite;
    Eigen::Index direction = 0;
    own.eigenvectors().col(0).cwiseAbs().maxCoeff(&direction);
    result.mode = name_mode(is_isotropic, iso.mean, iso.deviator, direction);
  } else if (!(below.eigenvalues()(0) >= -kRounding * std::max(scale, fluid.mean))) {
    result.status = MediumStatus::above_voigt;
    const Isotropic margin = average(voigt - result.stiffness);
    Eigen::Index direction = 0;
    below.eigenvectors().col(0).cwiseAbs().maxCoeff(&direction);
    result.mode = name_mode(is_isotropic, margin.mean, margin.deviator, direction);
  }
  return result;
}

MediumRange compute_medium_range(const Elastic& solid, const EffectiveMedium& medium, double phi_max) {
  constexpr int kSamples = 256;
  MediumRange range;
  const auto find_first = [&](int first_sample, MediumStatus at_least) {
    double low = phi_max * (first_sample - 1) / kSamples;
    double high = phi_max * first_sample / kSamples;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (compute_effective_medium(solid, medium, middle).status >= at_least ? high : low) = middle;
    }
    return high;
  };
  for (int i = 1; i <= kSamples; ++i) {
    const MediumResult result = compute_effective_medium(solid, medium, phi_max * i / kSamples);
    if (result.status > range.worst) range.mode = result.mode;
    range.worst = std::max(range.worst, result.status);
    if (result.status == MediumStatus::above_voigt && range.phi_above_voigt < 0.0)
      range.phi_above_voigt = find_first(i, MediumStatus::above_voigt);
    if (result.status == MediumStatus::not_positive_definite && range.phi_not_positive_definite < 0.0)
      range.phi_not_positive_definite = find_first(i, MediumStatus::not_positive_definite);
  }
  return range;
}

}  // namespace argil::material
