#pragma once

#include "base/types.h"
#include "material/transverse.h"

namespace argil::material {

/// Eshelby's tensor P of a spheroid in an isotropic matrix (6×6, Mandel; not symmetric): the strain inside an
/// inclusion with eigenstrain ε* is P ε*. Axis of revolution 3, `aspect` = length along it over the diameter
/// across it: 0 the penny (a layer), < 1 oblate, 1 sphere, > 1 prolate, ∞ the cylinder.  `poissons_ratio`
/// (–): the matrix's, in (−1, ½].  [Mura1987, eqs. 11.16–11.29] Entries are good to about 1e-15 of the
/// largest one at every aspect.
Mat6 compute_eshelby_tensor(double poissons_ratio, double aspect);

/// The same tensor in the basis in which its isotropic and its anisotropic parts stand apart.
Transverse compute_eshelby_transverse(double poissons_ratio, double aspect);

}  // namespace argil::material
