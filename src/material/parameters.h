#pragma once

#include <vector>

#include "base/types.h"

namespace argil::material {

/// Estimate of the stiffness of solid with fluid inclusions. All but the last five are members of
/// S(X) = [1 + φ(Q−X)⁻¹]S^M (eq. 6 generalised).
enum class Scheme {
  dilute,
  dilute_strain,
  mori_tanaka,
  self_consistent,
  differential,
  voigt,
  reuss,
  hs_lower,
  hs_upper
};
enum class Orientation { random, aligned };

/// Isotropic elastic constants of the dry clay.
struct Elastic {
  double youngs_modulus = 0.0;  ///< E [Pa], > 0
  double poissons_ratio = 0.0;  ///< ν [–], in (−1, ½)
};

/// Fluid inclusions in the clay.
struct EffectiveMedium {
  Scheme scheme = Scheme::mori_tanaka;
  double fluid_bulk_modulus = 0.0;   ///< K_I [Pa]; 0: drained
  double fluid_shear_modulus = 0.0;  ///< G_I [Pa]
  double aspect = 1.0;               ///< spheroid's axis 3 over axis 1 [–]; 1: sphere
  Orientation orientation = Orientation::random;
  Vec3 axis =
      Vec3::UnitZ();  ///< where axis 3 of aligned inclusions lies in the body at rest, unit length [–]
};

/// How water changes stiffness and yield beyond or instead of the effective medium.
enum class MoistureLaw {
  effective_medium,  ///< C from eq. 6; the yield strain as `yield_law` says
  liquidity_index,   ///< modulus and yield stress fall log-linearly from the plastic to the liquid limit
  table,             ///< the user's E(S) and yield(S), monotone interpolation
};

/// How the yield stress follows the saturation.
enum class YieldLaw {
  constant,    ///< the yield *strain* stays, as in the paper
  log_linear,  ///< yield strain × r^S with r = saturated_yield_ratio
};

struct Moisture {
  MoistureLaw law = MoistureLaw::effective_medium;
  EffectiveMedium medium;
  bool softens_elasticity = true;  ///< false: the modulus stays dry (to split a result into its causes)
  YieldLaw yield_law = YieldLaw::constant;
  double saturated_yield_ratio = 1.0;            ///< r [–], yield strain at S = 1 over dry, in (0, 1]
  double saturated_strength_ratio = 1.0 / 35.0;  ///< liquidity_index: at liquid over at plastic limit
  double plastic_limit_saturation = 0.0;         ///< liquidity_index: S_P, where the fall begins [–]
  double liquid_limit_saturation = 1.0;          ///< liquidity_index: S_L > S_P [–]; may lie above 1
  double suction_peak_ratio = 1.0;  ///< modulus and yield stress of slightly wet clay at their peak, over dry
  double suction_peak_saturation = 0.2;  ///< S of that peak [–], in (0, ½]
  double refresh_tolerance = 1e-4;  ///< change of S [–] beyond which a tet's moduli are looked up again
  std::vector<double> table_saturation;      ///< table: increasing, from 0 to 1
  std::vector<double> table_youngs_modulus;  ///< table: [Pa]
  std::vector<double> table_yield;           ///< table: yield strain [–]
};

/// Plastic flow in additive strain: after Müller and Gross 2004 in rate form or to the letter, or rate
/// independent.
enum class FlowForm {
  rate,           ///< 1 − e^{−c h} of the elastic strain
  rate_to_yield,  ///< the same, no further than to the yield norm
  literal,        ///< c h of it
  j2,             ///< radial return of its deviator to the yield norm [Wilkins1964]; takes no creep rate
};
enum class StrainNorm { frobenius, voigt6 };

struct Plasticity {
  bool enabled = true;
  double yield = 0.0;        ///< elastic strain norm at which flow starts [–]
  double strength = 0.0;     ///< c_u, undrained shear strength of dry clay [Pa]; 0: by `yield`
  double creep_per_s = 0.0;  ///< c [1/s]
  double max = 0.0;          ///< cap on the plastic strain norm [–]; 0: none
  bool deviatoric = true;    ///< flow keeps the volume
  FlowForm form = FlowForm::rate;
  /// j2: by how much of itself the strength rises with every tenfold shear strain rate, above the rate at
  /// which it was measured, √2 ‖ε̇_p‖ [1/s] (1 % a minute of a triaxial test). About a tenth [Einav2005].
  double rate_growth = 0.0;
  double reference_rate = 3e-4;
  StrainNorm norm = StrainNorm::frobenius;
};

/// Clay kernel, eq. 9.
enum class KernelForm { rate, per_step, off };

struct ClayKernel {
  KernelForm form = KernelForm::rate;
  double k1 = 0.0;      ///< [1/m]
  double k2 = 0.0;      ///< [1/m]
  double radius = 0.0;  ///< R_D [m]
  double reference_step =
      0.014;  ///< h_ref [s]: the step at which one factor G_d is applied (the paper's 71.4 Hz)
};

}  // namespace argil::material
