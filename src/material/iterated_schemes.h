#pragma once

#include "material/transverse.h"

namespace argil::material {

/// The two schemes whose matrix is the wanted medium itself, and what they share with the others.

/// Strain concentration A = (1 − P T)⁻¹ of one spheroid in an infinite `matrix`, T = S^M (C^M − C^I) (eq. 6
/// in a form that inverts nothing that may be singular).  C^M must be positive definite.
Transverse compute_concentration(const Isotropic& matrix, const Isotropic& fluid, double aspect);

/// Solution of C = C^M + φ (C^I − C^M) ⟨A(C)⟩, ⟨·⟩ the average over orientations [Hill1965, Budiansky1965].
/// Beyond the percolation point the solid no longer hangs together: deviator 0, mean part Reuss's (the
/// suspension).
Isotropic compute_self_consistent(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect);

/// Solution at φ of dC/dφ = (C^I − C) ⟨A(C)⟩ / (1 − φ), C(0) = C^M [Norris1985], to a relative error of about
/// 1e-11. Flat pores let the shear modulus fall like e^{−φ/aspect}: below 1e-130 of the solid's it is 0.
Isotropic compute_differential(const Isotropic& solid, const Isotropic& fluid, double phi, double aspect);

}  // namespace argil::material
