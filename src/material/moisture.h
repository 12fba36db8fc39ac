#pragma once

#include "material/effective_medium.h"
#include "material/parameters.h"

namespace argil::material {

/// Stiffness and strength of clay of one saturation S, dry clay included.
struct MoistState {
  double lambda = 0.0;  ///< Lamé λ of the isotropic part [Pa]
  double mu = 0.0;      ///< Lamé μ of the isotropic part [Pa]
  double yield = 0.0;   ///< elastic strain norm at which it flows [–]
};

/// False where water gives the clay a preferred axis: aligned inclusions that are no spheres, in a law that
/// uses them.
bool is_isotropic(const Moisture& moisture);

/// Modulus and yield stress over those of dry clay between the limits of the measured law: r^{I_L}, r =
/// saturated_strength_ratio, I_L = (S − S_P)/(S_L − S_P) the liquidity index; 1 below the plastic limit,
/// where the law was not measured [Vardanega2014: r = 1/35, 0.2 < I_L < 1.1]. For water contents w by dry
/// mass, S = w (1 − n) ρ_s/(n ρ_w), ρ_s the density of the grains.
double compute_liquidity_factor(const Moisture& moisture, double saturation);

/// Modulus and yield stress over those without suction. Menisci between the grains press them together; in
/// dry and in saturated clay there are none. The suction stress S·s(S) [Bishop1959, Lu2006] rises from zero
/// to one peak and falls to zero again: 1 + (p − 1)·(S/S_p)·((1 − S)/(1 − S_p))^b with b = (1 − S_p)/S_p,
/// which is p at S_p. The shape is ours; the peak is the user's.
double compute_suction_factor(const Moisture& moisture, double saturation);

/// The laws of one clay as functions of S in [0, 1]; φ = n·S. The effective medium is tabulated finely once,
/// so that a lookup costs little; every tet sees the same bits.
///   effective_medium  moduli of compute_effective_medium at φ = n S.
///   liquidity_index   modulus and yield stress both times compute_liquidity_factor; the yield strain, their
///                     ratio, therefore stays.
///   table             E(S) and yield strain(S) of the user, monotone cubic; Poisson's ratio stays dry.
/// On top of any of them modulus and yield stress take compute_suction_factor, and `log_linear` multiplies
/// the yield strain by saturated_yield_ratio^S. With softens_elasticity off the modulus stays dry throughout
/// and the yield strain takes what the strength does. Whether the effective medium is a stiffness at every S
/// that a run can reach is asked beforehand with compute_medium_range; the table itself holds whatever the
/// law gives.
class MoistureTable {
 public:
  /// `yield` (–): dry yield strain.  `porosity` n (–).  Requires is_supported(moisture.medium), table columns
  /// of equal length ≥ 2 with S increasing from 0 to 1.
  MoistureTable(const Elastic& dry, double yield, const Moisture& moisture, double porosity);
  MoistState at(double saturation) const;
  /// Full stiffness at S (Mandel) with the inclusions' axis along `axis` (unit length). Only when not
  /// is_isotropic().
  Mat6 stiffness_at(double saturation, const Vec3& axis) const;

  /// The same of clay of this dry Young's modulus [Pa] in place of the material's. Nothing but the effective
  /// medium of water with a stiffness of its own knows more than a factor: there the law is evaluated, which
  /// costs a scheme each time, for C(E, K_I) is not E times C(1, K_I).  `table`: E(S)/E(0) counts.
  MoistState at(double saturation, double youngs_modulus) const;
  Mat6 stiffness_at(double saturation, const Vec3& axis, double youngs_modulus) const;
  bool is_isotropic() const;  ///< of its law

 private:
  MoistState with_strength(MoistState state, double saturation) const;
  bool is_proportional() const;
  MediumResult evaluate(double saturation, double youngs_modulus) const;

  Elastic m_dry;
  double m_yield;
  double m_porosity;
  Moisture m_moisture;
  std::vector<MoistState>
      m_states;  // of the effective medium at S = i/(size−1); empty where it does not count
  std::vector<Mat6> m_stiffness;  // axis 3; empty when isotropic
};

}  // namespace argil::material
