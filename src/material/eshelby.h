#pragma once

#include "base/types.h"

namespace argil::material {

/// Eshelby's tensor P of a spheroid in an isotropic matrix (6×6, Mandel; not symmetric): the strain inside an
/// inclusion with eigenstrain ε* is P ε*. Axis of revolution 3, `aspect` = length along it over the diameter
/// across it
/// (< 1 oblate, 1 sphere, > 1 prolate).  [Mura1987, eqs. 11.16–11.29]
/// Near the sphere the closed forms cancel; there the same integrals are taken by a Gauss rule.
Mat6 compute_eshelby_tensor(double poissons_ratio, double aspect);

}  // namespace argil::material
