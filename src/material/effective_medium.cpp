#include "material/effective_medium.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "material/iterated_schemes.h"

namespace argil::material {
namespace {

Isotropic make_solid(const Elastic& solid) {
  const double E = solid.youngs_modulus;
  const double nu = solid.poissons_ratio;
  return {E / (1.0 - 2.0 * nu), E / (1.0 + nu)};
}

Isotropic make_fluid(const EffectiveMedium& medium) {
  return {3.0 * medium.fluid_bulk_modulus, 2.0 * medium.fluid_shear_modulus};
}

Isotropic compute_voigt(const Isotropic& solid, const Isotropic& fluid, double phi) {
  return {(1.0 - phi) * solid.mean + phi * fluid.mean, (1.0 - phi) * solid.deviator + phi * fluid.deviator};
}

Isotropic compute_reuss(const Isotropic& solid, const Isotropic& fluid, double phi) {
  const auto harmonic = [phi](double s, double f) {
    return phi > 0.0 ? s * f / ((1.0 - phi) * f + phi * s) : s;
  };
  return {harmonic(solid.mean, fluid.mean), harmonic(solid.deviator, fluid.deviator)};
}

/// Hashin–Shtrikman expression with the reference medium's stiffness [Hashin1963; Walpole1966 where the
/// stiffer in bulk is the softer in shear].
Isotropic compute_hashin_shtrikman(const Isotropic& solid, const Isotropic& fluid, double phi,
                                   const Isotropic& reference) {
  const double K = reference.mean / 3.0;
  const double G = reference.deviator / 2.0;
  const double bulk_star = 4.0 * G / 3.0;
  const double shear_star = G > 0.0 ? G * (9.0 * K + 8.0 * G) / (6.0 * (K + 2.0 * G)) : 0.0;
  // 1/((1−φ)/(s+*) + φ/(f+*)) − *, with * taken out of the difference
  const auto mix = [phi](double s, double f, double star) {
    if (phi == 0.0) return s;
    return (s * f + star * ((1.0 - phi) * s + phi * f)) / ((1.0 - phi) * f + phi * s + star);
  };
  return {3.0 * mix(solid.mean / 3.0, fluid.mean / 3.0, bulk_star),
          2.0 * mix(solid.deviator / 2.0, fluid.deviator / 2.0, shear_star)};
}

Transverse compute_stiffness(const Isotropic& solid, const EffectiveMedium& medium, double phi) {
  const Isotropic fluid = make_fluid(medium);
  const Transverse one = to_transverse({1.0, 1.0});
  const Transverse C_M = to_transverse(solid);
  const Transverse T = to_transverse({1.0 - fluid.mean / solid.mean, 1.0 - fluid.deviator / solid.deviator});
  // ⟨A⟩. T and C_M are isotropic, so they may stand outside the average over orientations.
  const auto concentration = [&] {
    const Transverse A = compute_concentration(solid, fluid, medium.aspect);
    return medium.orientation == Orientation::random ? to_transverse(average(A)) : A;
  };
  switch (medium.scheme) {
    case Scheme::dilute:  // eq. 6: S = [1 + φ T A] S^M
      return C_M * inverse(combine(1.0, one, phi, T * concentration()));
    case Scheme::dilute_strain:  // C = C^M [1 − φ T A]
      return C_M * combine(1.0, one, -phi, T * concentration());
    case Scheme::mori_tanaka: {  // C = [(1−φ) C^M + φ C^I A] [(1−φ) + φ A]⁻¹, C^I = C^M (1 − T)  [Mori1973]
      const Transverse A = concentration();
      const Transverse mixed = combine(1.0 - phi, one, phi, A);
      return C_M * combine(1.0 - phi, one, phi, combine(1.0, one, -1.0, T) * A) * inverse(mixed);
    }
    case Scheme::self_consistent:
      return to_transverse(compute_self_consistent(solid, fluid, phi, medium.aspect));
    case Scheme::differential:
      return to_transverse(compute_differential(solid, fluid, phi, medium.aspect));
    case Scheme::voigt:  // eq. 3
      return to_transverse(compute_voigt(solid, fluid, phi));
    case Scheme::reuss:  // eq. 4
      return to_transverse(compute_reuss(solid, fluid, phi));
    case Scheme::hs_lower:
      return to_transverse(compute_hashin_shtrikman(
          solid, fluid, phi, {std::min(solid.mean, fluid.mean), std::min(solid.deviator, fluid.deviator)}));
    case Scheme::hs_upper:
      return to_transverse(compute_hashin_shtrikman(
          solid, fluid, phi, {std::max(solid.mean, fluid.mean), std::max(solid.deviator, fluid.deviator)}));
  }
  return C_M;
}

/// Extreme eigenvalues of the symmetric 2×2 block and of the two shears, and which of the three it is.
struct Extreme {
  double value;
  int block;  // 0: mean part and axisymmetric shear, 1: shear in the plane 12, 2: shear 13 and 23
};

Extreme find_extreme(const Transverse& a, double sign) {
  // The root of larger magnitude first, the other from the determinant: neither cancels.
  const double middle = 0.5 * (a.uu + a.ww);
  const double radius = std::hypot(0.5 * (a.uu - a.ww), a.uw);
  const double larger = middle + std::copysign(radius, middle);
  double smaller = larger != 0.0 ? (a.uu * a.ww - a.uw * a.wu) / larger : 0.0;
  if (a.uw == 0.0) smaller = std::abs(a.uu) < std::abs(a.ww) ? a.uu : a.ww;
  Extreme extreme{sign * larger > sign * smaller ? larger : smaller, 0};
  if (sign * a.plane > sign * extreme.value) extreme = {a.plane, 1};
  if (sign * a.axial > sign * extreme.value) extreme = {a.axial, 2};
  return extreme;
}

std::string name_mode(bool isotropic, bool is_bulk, int block) {
  if (isotropic) return is_bulk ? "bulk" : "shear";
  constexpr const char* kNames[] = {"axisymmetric", "shear 12", "shear 13"};
  return kNames[block];
}

/// C measured by an isotropic positive V: V^{−1/2} C V^{−1/2}. Where V is zero, any stiffness counts as
/// infinite.
Transverse compute_ratio(const Transverse& C, const Isotropic& V) {
  const auto over = [](double a, double v) {
    return v > 0.0 ? a / v : (a > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
  };
  const double cross = std::sqrt(V.mean * V.deviator);
  return {over(C.uu, V.mean),     over(C.uw, cross),         over(C.wu, cross),
          over(C.ww, V.deviator), over(C.plane, V.deviator), over(C.axial, V.deviator)};
}

void set_status(const Isotropic& solid, const EffectiveMedium& medium, double phi, const Transverse& C,
                MediumResult& result) {
  // Rounding of a ratio of two moduli, with room for the inverses on the way.
  constexpr double kRounding = 1e-12;
  const bool isotropic = is_isotropic(medium);
  const Transverse by_solid = compute_ratio(C, solid);
  const Transverse by_voigt = compute_ratio(C, compute_voigt(solid, make_fluid(medium), phi));
  if (const Extreme least = find_extreme(by_solid, -1.0); !(least.value > 0.0)) {
    result.status = MediumStatus::not_positive_definite;
    result.mode = name_mode(isotropic, by_solid.uu < by_solid.ww, least.block);
  } else if (const Extreme most = find_extreme(by_voigt, 1.0); !(most.value <= 1.0 + kRounding)) {
    result.status = MediumStatus::above_voigt;
    result.mode = name_mode(isotropic, by_voigt.uu > by_voigt.ww, most.block);
  }
}

}  // namespace

bool is_supported(const EffectiveMedium& medium) {
  const bool needs_isotropic_matrix =
      medium.scheme == Scheme::self_consistent || medium.scheme == Scheme::differential;
  return !(needs_isotropic_matrix && medium.orientation == Orientation::aligned && medium.aspect != 1.0);
}

bool is_isotropic(const EffectiveMedium& medium) {
  const bool ignores_shape = medium.scheme == Scheme::voigt || medium.scheme == Scheme::reuss ||
                             medium.scheme == Scheme::hs_lower || medium.scheme == Scheme::hs_upper;
  return ignores_shape || medium.aspect == 1.0 || medium.orientation == Orientation::random;
}

MediumResult compute_effective_medium(const Elastic& elastic, const EffectiveMedium& medium, double phi) {
  ARGIL_ASSERT(is_supported(medium));
  ARGIL_ASSERT(phi >= 0.0 && phi <= 1.0, phi);
  const Isotropic solid = make_solid(elastic);
  Transverse C = compute_stiffness(solid, medium, phi);
  C.uw = C.wu = 0.5 * (C.uw + C.wu);  // symmetric but for rounding
  const Isotropic mean = average(C);
  MediumResult result;
  result.stiffness = to_mandel_matrix(C);
  result.bulk_modulus = mean.mean / 3.0;
  result.shear_modulus = mean.deviator / 2.0;
  set_status(solid, medium, phi, C, result);
  return result;
}

MediumRange compute_medium_range(const Elastic& solid, const EffectiveMedium& medium, double phi_max) {
  constexpr int kSamples = 256;
  constexpr int kHalvings = 60;
  MediumRange range;
  const auto status_at = [&](double phi) { return compute_effective_medium(solid, medium, phi); };
  const auto find_first = [&](int sample, MediumStatus at_least) {
    double low = phi_max * (sample - 1) / kSamples;
    double high = phi_max * sample / kSamples;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (status_at(middle).status >= at_least ? high : low) = middle;
    }
    return high;
  };
  for (int i = 1; i <= kSamples; ++i) {
    const MediumStatus status = status_at(phi_max * i / kSamples).status;
    if (status == MediumStatus::not_positive_definite && range.phi_not_positive_definite < 0.0)
      range.phi_not_positive_definite = find_first(i, MediumStatus::not_positive_definite);
    // Next to a pole the stay above Voigt may be shorter than a sample; it still comes first.
    if (status != MediumStatus::ok && range.worst == MediumStatus::ok) {
      const double first = find_first(i, MediumStatus::above_voigt);
      if (status_at(first).status == MediumStatus::above_voigt) range.phi_above_voigt = first;
    }
    range.worst = std::max(range.worst, status);
  }
  const double first = range.worst == MediumStatus::not_positive_definite ? range.phi_not_positive_definite
                                                                          : range.phi_above_voigt;
  if (first >= 0.0) range.mode = status_at(first).mode;
  return range;
}

}  // namespace argil::material
