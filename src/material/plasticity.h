#pragma once

#include "material/parameters.h"

namespace argil::material {

/// Plastic strain (Mandel) after a step of `step_s` seconds at held total strain [Mueller2004; rate form:
/// ours]:
///   ε_e = ε − ε_p (its deviator when `deviatoric`, so that the volume neither flows nor counts for
///   yielding); if ‖ε_e‖ > yield: ε_p += (1 − e^{−c h}) ε_e  (literal: + c h ε_e, sensible for c h ≤ 1 only);
///   then ‖ε_p‖ ≤ max by scaling.
/// j2: ε_p += (1 − yield/‖ε_e‖) ε_e with the deviator and the Frobenius norm: von Mises's law without
/// hardening, tensile strength σ_y = √6 μ·yield, whatever the step. `strain`, `plastic_strain` (6, Mandel):
/// total and plastic strain in the same (turned) frame. Norm: `frobenius` √(ε:ε), the same in every frame;
/// `voigt6`, the original's √(ε₁₁²+ε₂₂²+ε₃₃²+ε₂₃²+ε₁₃²+ε₁₂²) with tensor shears, which counts a shear by 1/√2
/// of what it counts when the axes are turned by 45°. In the rate form the result does not depend on how the
/// time is cut while ‖ε_e‖ stays above yield; the deviatoric Frobenius flow never raises the elastic energy
/// of an isotropic law, cap included.
Vec6 compute_plastic_strain(const Vec6& strain, const Vec6& plastic_strain, double yield,
                            const Plasticity& law, double step_s);

/// G_d(r), eq. 9, without overflow. r, radius [m]; k1, k2 [1/m].
double compute_clay_weight(double r, const ClayKernel& kernel);

/// Factor on a velocity at distance r over a step h: G_d^{h/h_ref} (rate), G_d (per step) or 1 (off).
double compute_clay_factor(double r, const ClayKernel& kernel, double step_s);

}  // namespace argil::material
