#pragma once

#include <string>

#include "material/parameters.h"

namespace argil::material {

/// Where an estimate stands against eq. 5: inside, stiffer than the Voigt bound in some strain, or not a
/// stiffness at all. (Below Reuss is not a status: with a fluid that is drained or free of shear the Reuss
/// bound is zero and the last status says it; undrained, `dilute_strain` alone can pass below Reuss's bulk
/// modulus.)
enum class MediumStatus { ok, above_voigt, not_positive_definite };

/// Effective stiffness and how far it can be trusted.
struct MediumResult {
  Mat6 stiffness = Mat6::Zero();  ///< C [Pa], Mandel, spheroid axis 3 when aligned
  double bulk_modulus = 0.0;      ///< K of the isotropic part [Pa]
  double shear_modulus = 0.0;     ///< G of the isotropic part [Pa]
  MediumStatus status = MediumStatus::ok;
  /// What left the bound, empty when ok: "bulk" or "shear" of an isotropic result, else "axisymmetric",
  /// "shear 12" or "shear 13".
  std::string mode;
};

/// False for combinations that would need Eshelby's tensor in an anisotropic matrix: self_consistent and
/// differential with aligned spheroids.
bool is_supported(const EffectiveMedium& medium);

/// False when the stiffness has a preferred axis: aligned spheroids in a scheme that knows their shape.
bool is_isotropic(const EffectiveMedium& medium);

/// Effective stiffness of `solid` with volume fraction `phi` (in [0, 1]) of inclusions: eq. 6 and its
/// relatives. With T = S^M (C^M − C^I), A = (1 − P T)⁻¹ and ⟨·⟩ the average over orientations (`random`
/// only):
///   dilute (the paper)  S = [1 + φ T⟨A⟩] S^M            dilute_strain    C = C^M [1 − φ T⟨A⟩]
///   mori_tanaka         C = C^M [1 − φ T⟨A⟩ ((1−φ) + φ⟨A⟩)⁻¹]
///   self_consistent     C = C^M + φ (C^I − C^M)⟨A(C)⟩   differential     dC/dφ = (C^I − C)⟨A(C)⟩/(1−φ)
///   voigt (eq. 3), reuss (eq. 4), hs_lower, hs_upper: bounds for any isotropic mixture.
/// A zero modulus of the fluid is allowed (drained). C^M − C^I is never inverted. Requires
/// is_supported(medium).
MediumResult compute_effective_medium(const Elastic& solid, const EffectiveMedium& medium, double phi);

/// Status over the whole range (0, phi_max]: the first φ at which it leaves `ok`, and how. Sampled at 256
/// places; the first change of status is then bisected to the last bit.
struct MediumRange {
  MediumStatus worst = MediumStatus::ok;
  double phi_above_voigt = -1.0;            ///< first φ above the Voigt bound; −1: none
  double phi_not_positive_definite = -1.0;  ///< first φ where C is not positive definite; −1: none
  std::string mode;                         ///< of the worst, where it is first reached
};
MediumRange compute_medium_range(const Elastic& solid, const EffectiveMedium& medium, double phi_max);

}  // namespace argil::material
