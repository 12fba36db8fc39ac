#pragma once

#include <string>

#include "material/parameters.h"

namespace argil::material {

enum class MediumStatus { ok, above_voigt, not_positive_definite };

/// Effective stiffness and how far it can be trusted.
struct MediumResult {
  Mat6 stiffness = Mat6::Zero();  ///< C [Pa], Mandel, spheroid axis 3 when aligned
  double bulk_modulus = 0.0;      ///< K of the isotropic part [Pa]
  double shear_modulus = 0.0;     ///< G of the isotropic part [Pa]
  MediumStatus status = MediumStatus::ok;
  std::string mode;  ///< "bulk" or "shear" (isotropic) or "mode n": which left the bound; empty when ok
};

/// False for combinations that would need Eshelby's tensor in an anisotropic matrix: self_consistent and
/// differential with aligned spheroids.
bool is_supported(const EffectiveMedium& medium);

/// Effective stiffness of `solid` with volume fraction `phi` of inclusions (eq. 6 and its relatives).
/// Requires is_supported(medium).
MediumResult compute_effective_medium(const Elastic& solid, const EffectiveMedium& medium, double phi);

/// Status over the whole range [0, phi_max]: the first φ at which it leaves `ok`, and how. Sampled and
/// bisected.
struct MediumRange {
  MediumStatus worst = MediumStatus::ok;
  double phi_above_voigt = -1.0;            ///< first φ above the Voigt bound; −1: none
  double phi_not_positive_definite = -1.0;  ///< first φ where C is not positive definite; −1: none
  std::string mode;                         ///< of the worst
};
MediumRange compute_medium_range(const Elastic& solid, const EffectiveMedium& medium, double phi_max);

}  // namespace argil::material
