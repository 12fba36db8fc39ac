#pragma once

#include "base/types.h"

namespace argil::sim {

/// Where a pressure acts when a step of the body ends, by the moments of its forces: those hardly hang on κ,
/// while the area that the tool covers does.
struct PressedPatch {
  double springs = 0.0;  ///< stiffness of the contacts that press [N/m]; 0: nothing presses
  double length =
      0.0;  ///< longer semi-axis of an ellipse on which Hertz's pressure would lie as far apart [m]
  double width = 0.0;  ///< shorter one [m]
  /// By how much the body yields until the end of a step where a unit of force acts that is shared out like
  /// those [m/N], by its own matrix; 0: not known.
  double compliance = 0.0;
  double drift = 0.0;  ///< how far the body goes there in the next step if the forces stay [m], into the clay

  /// dF/dd of an elastic half-space of modulus E* [Pa] under a flat tool of that outline [N/m]: π E* a / K(e)
  /// with the longer semi-axis a, the complete elliptic integral K of the first kind and the ellipse's
  /// eccentricity e; 2 E* a for a disc [Johnson1985]. Forces on few nodes press as on a part of a `cell` [m].
  /// 0 where nothing presses.
  double find_half_space_stiffness(double modulus, double cell) const;
};

/// Sums those moments up.
class PressedMoments {
 public:
  /// A point [m] that presses with a force [N]; one that does not counts for nothing.
  void add(const Vec3& point, double force, double spring);
  PressedPatch find_patch() const;

 private:
  double m_springs = 0.0;
  double m_force = 0.0;
  Vec3 m_centre = Vec3::Zero();
  Mat3 m_spread = Mat3::Zero();  // Σ f (x − centre)(x − centre)ᵀ [N m²]
};

}  // namespace argil::sim
