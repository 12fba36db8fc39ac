#pragma once

#include "material/effective_medium.h"
#include "material/parameters.h"

namespace argil::material {

/// What a tet of saturation S offers the solid.
struct WetState {
  double lambda = 0.0;  ///< Lamé λ of the isotropic part [Pa]
  double mu = 0.0;      ///< Lamé μ of the isotropic part [Pa]
  double yield = 0.0;   ///< elastic strain norm at which it flows [–]
};

/// The laws of one clay as functions of S in [0, 1], tabulated finely once so that a lookup costs nothing and
/// every tet sees the same bits; φ = n·S.
///   effective_medium  moduli of compute_effective_medium at φ = n S.
///   liquidity_index   modulus and yield stress both times r^S, r = saturated_strength_ratio [Vardanega2014];
///   the
///                     yield strain, their ratio, therefore stays. With softens_elasticity off the modulus
///                     stays dry and the yield strain takes the whole fall of the strength.
///   table             E(S) and yield strain(S) of the user, monotone cubic; Poisson's ratio stays dry.
/// On top of any of them `log_linear` multiplies the yield strain by saturated_yield_ratio^S.
/// Whether the effective medium is a stiffness at every S that a run can reach is asked beforehand with
/// compute_medium_range; the table itself holds whatever the law gives.
class MoistureTable {
 public:
  /// `yield` (–): dry yield strain.  `porosity` n (–).  Requires is_supported(moisture.medium), table columns
  /// of equal length ≥ 2 with S increasing from 0 to 1.
  MoistureTable(const Elastic& dry, double yield, const Moisture& moisture, double porosity);
  WetState at(double saturation) const;
  /// Full stiffness (Mandel, axis 3) at S. Only when not is_isotropic().
  Mat6 stiffness_at(double saturation) const;
  /// False only for aligned inclusions that are no spheres, in a law that uses them.
  bool is_isotropic() const;

 private:
  std::vector<WetState> m_states;  // at S = i/(size−1)
  std::vector<Mat6> m_stiffness;   // empty when isotropic
};

}  // namespace argil::material
