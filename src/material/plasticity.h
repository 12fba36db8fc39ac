#pragma once

#include "material/parameters.h"

namespace argil::material {

/// Plastic strain (Mandel) after a step of `step_s` seconds [Müller & Gross 2004, rate form]:
/// ε_e = ε − ε_p; if ‖ε_e‖ > yield: ε_p += (1 − e^{−c h}) ε_e  (literal: + h c ε_e); then ‖ε_p‖ ≤ max.
/// `strain`, `plastic_strain` (6, Mandel): total and plastic strain in the same (rotated) frame.
Vec6 compute_plastic_strain(const Vec6& strain, const Vec6& plastic_strain, double yield,
                            const Plasticity& law, double step_s);

/// G_d(r), eq. 9, without overflow. r, radius [m]; k1, k2 [1/m].
double compute_clay_weight(double r, const ClayKernel& kernel);

/// Factor on a velocity at distance r over a step h: G_d^{h/h_ref} (rate), G_d (per step) or 1 (off).
double compute_clay_factor(double r, const ClayKernel& kernel, double step_s);

}  // namespace argil::material
