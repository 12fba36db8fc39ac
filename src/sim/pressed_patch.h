#pragma once

#include "base/types.h"

namespace argil::sim {

/// Where the answer of a step presses, by the moments of its forces, and how the body goes on there. Those
/// forces hardly hang on κ, while the area that the tool covers does.
struct PressedPatch {
  double springs = 0.0;  ///< stiffness of the contacts that press [N/m]; 0: nothing presses
  double length = 0.0;   ///< longer semi-axis [m] of an ellipse on which Hertz's pressure lies as far apart
  double width = 0.0;    ///< shorter one [m]
  /// How far the body goes there until the end of the next step for a unit of force that is shared out like
  /// those [m/N], by its own matrix. Without friction and grip of a force into the clay alone; 0: not known.
  Mat3 compliance = Mat3::Zero();
  Vec3 drift = Vec3::Zero();  ///< and how far if the forces stay as they are [m]

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
