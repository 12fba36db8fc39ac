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
/// every tet sees the same bits. φ = n·S.
class MoistureTable {
 public:
  MoistureTable(const Elastic& dry, double yield, const Moisture& moisture, double porosity);
  WetState at(double saturation) const;
  /// Full stiffness (Mandel, axis 3) at S; differs from the isotropic part only for aligned inclusions.
  Mat6 stiffness_at(double saturation) const;
  bool is_isotropic() const;

 private:
  std::vector<WetState> m_states;  // at S = i/(size−1)
  std::vector<Mat6> m_stiffness;   // aligned inclusions only
};

}  // namespace argil::material
