#pragma once

#include "material/parameters.h"

namespace argil::material {

/// What flow knows of a point beside its strain.
struct FlowPoint {
  double yield = 0.0;               ///< elastic strain norm at which flow starts [–]
  const Mat6* direction = nullptr;  ///< see make_flow_direction; none: isotropic elasticity
};

/// Plastic strain (Mandel) after a step of `step_s` seconds at held total strain [Mueller2004; rate forms and
/// j2: ours]. With ε_e = ε − ε_p, or its deviator when `deviatoric`, so that the volume neither flows nor
/// counts for yielding: if ‖ε_e‖ > yield, ε_p += f ε_e, then ‖ε_p‖ ≤ max by scaling.
///   rate           f = 1 − e^{−c h}: independent of how the time is cut while ‖ε_e‖ stays above yield; the
///   last
///                  step goes past it, to first order in h
///   rate_to_yield  f = min(1 − e^{−c h}, 1 − yield/‖ε_e‖): the solution of ε̇_p = c ε_e while ‖ε_e‖ > yield,
///   which
///                  stops there; independent of how the time is cut
///   literal        f = c h, sensible for c h ≤ 1 only
///   j2             f = 1 − yield/‖ε_e‖ with the deviator and the Frobenius norm: von Mises's law without
///                  hardening, tensile strength σ_y = √6 μ·yield, whatever the step
/// Norm: `frobenius` √(ε:ε), the same in every frame; `voigt6`, the original's
/// √(ε₁₁²+ε₂₂²+ε₃₃²+ε₂₃²+ε₁₃²+ε₁₂²) with tensor shears, which counts a shear by 1/√2 of what it counts when
/// the axes are turned by 45°. Deviatoric flow with `direction`: q = B ε_e takes the place of ε_e (not for
/// j2), and flow ends where it reaches the cap. With c h ≤ 2, deviatoric flow in the Frobenius norm never
/// raises the elastic energy ½ ε_e:C:ε_e, cap included. `strain`, `plastic_strain` (6, Mandel): total and
/// plastic strain in the same (turned) frame.
Vec6 compute_plastic_strain(const Vec6& strain, const Vec6& plastic_strain, const FlowPoint& point,
                            const Plasticity& law, double step_s);

/// B with q = B ε_e = dev(C ε_e)/(2μ*): the stress deviator as a strain, along which deviatoric flow in an
/// anisotropic stiffness C (Mandel) [Pa] loses energy, which along dev ε_e it may gain. 2μ* is the largest
/// stiffness against a change of shape, so that B = dev for an isotropic C.
Mat6 make_flow_direction(const Mat6& C);

/// G_d(r), eq. 9, without overflow. r, radius [m]; k1, k2 [1/m].
double compute_clay_weight(double r, const ClayKernel& kernel);

/// Factor on a velocity at distance r over a step h: G_d^{h/h_ref} (rate), G_d (per step) or 1 (off).
double compute_clay_factor(double r, const ClayKernel& kernel, double step_s);

}  // namespace argil::material
