#pragma once

#include <cstddef>

#include "material/parameters.h"

namespace argil::material {

/// What flow knows of a point beside its strain.
struct FlowPoint {
  double yield = 0.0;           ///< elastic strain norm at which flow starts [–]
  const Vec6* drive = nullptr;  ///< what flows and yields in the place of dev ε_e, when `deviatoric`: along
                                ///< it elasticity that is not isotropic and linear loses energy
};

/// Norm of the elastic strain deviator at which dry clay flows [–]: given, or that of its undrained shear
/// strength c_u in pure shear, where ‖dev ε_e‖ = c_u/(√2 G) (von Mises, σ_y = √3 c_u in tension).
double compute_yield_strain(const Plasticity& law, const Elastic& dry);

/// How much of the elastic strain flows in a step: `most` of it, or, where that is less and `stops_at_yield`,
/// what is beyond the yield. That may rise with the rate, y (1 + a max(0, log₁₀(‖Δε_p‖/Δ₀))) [Einav2005].
struct FlowRule {
  double most = 1.0;  ///< [–]
  bool stops_at_yield = true;
  double growth = 0.0;          ///< a, a decade
  double reference_flow = 0.0;  ///< Δ₀, ‖Δε_p‖ of a step at the rate from which it rises
  double find_share(double norm, double yield) const;
};
FlowRule make_flow_rule(const Plasticity& law, double step_s);

/// Plastic strain (Mandel) after a step of `step_s` seconds at held total strain [Mueller2004; rate forms and
/// j2: ours]. With ε_e = ε − ε_p, or its deviator when `deviatoric`, so that the volume neither flows nor
/// counts for yielding: if ‖ε_e‖ > yield, ε_p += f ε_e, then ‖ε_p‖ ≤ max, where it is not 0, by scaling.
///   rate           f = 1 − e^{−c h}: independent of how the time is cut while ‖ε_e‖ stays above yield; the
///   last
///                  step goes past it, to first order in h
///   rate_to_yield  f = min(1 − e^{−c h}, 1 − yield/‖ε_e‖): the solution of ε̇_p = c ε_e while ‖ε_e‖ > yield,
///   which
///                  stops there; independent of how the time is cut
///   literal        f = c h, sensible for c h ≤ 1 only
///   j2             f = 1 − yield/‖ε_e‖ with the deviator and the Frobenius norm: von Mises's law without
///                  hardening, tensile strength σ_y = √6 μ·yield, whatever the step; with `rate_growth` it
///                  rises with the rate
/// Norm: `frobenius` √(ε:ε), the same in every frame; `voigt6`, the original's
/// √(ε₁₁²+ε₂₂²+ε₃₃²+ε₂₃²+ε₁₃²+ε₁₂²) with tensor shears, which counts a shear by 1/√2 of what it counts when
/// the axes are turned by 45°. Flow with a `drive` ends where it reaches the cap.
/// Deviatoric flow in the Frobenius norm never raises the elastic energy ½ ε_e:C:ε_e, cap included, where C
/// is isotropic or the drive is compute_stress_drive's. `strain`, `plastic_strain` (6, Mandel): total and
/// plastic strain in the same (turned) frame.
Vec6 compute_plastic_strain(const Vec6& strain, const Vec6& plastic_strain, const FlowPoint& point,
                            const Plasticity& law, double step_s);

/// 2μ*, the largest stiffness of C (Mandel) against a change of shape [Pa]: that of dev C dev; 2μ when
/// isotropic.
double compute_shape_stiffness(const Mat6& C);

/// dev σ/(2μ*): the stress deviator as a strain, dev ε_e when isotropic. `stress` (6, Mandel) [Pa].
Vec6 compute_stress_drive(const Vec6& stress, double shape_stiffness);

/// May point t of begin … end−1 (at most kLanes) flow at all? Bit t − begin; certain where it is 0. For
/// points without `drive`; arrays: 6, 6 and 1 a point.
unsigned find_flowing(const double* strain, const double* plastic_strain, const double* yield,
                      const Plasticity& law, std::ptrdiff_t begin, std::ptrdiff_t end);

/// G_d(r), eq. 9, without overflow. r, radius [m]; k1, k2 [1/m].
double compute_clay_weight(double r, const ClayKernel& kernel);

/// Factor on a velocity at distance r over a step h: G_d^{h/h_ref} (rate), G_d (per step) or 1 (off).
double compute_clay_factor(double r, const ClayKernel& kernel, double step_s);

}  // namespace argil::material
