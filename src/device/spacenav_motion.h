#pragma once

#include <array>

#include "base/types.h"

namespace argil::device::internal {

/// A 6-DoF controller gives how far its cap is moved and turned; that is taken as a speed. At the usual full
/// deflection of 350 counts: 7 cm/s and 1 rad/s.
inline constexpr double kSpeedPerCount = 2e-4;           ///< [m/s]
inline constexpr double kTurnSpeedPerCount = 1.0 / 350;  ///< [rad/s]
inline constexpr double kSpacenavReach = 0.2;            ///< [m]; the point stays within ± this on each axis

/// Where a controller's cap has taken the hand's point.
struct SpacenavPose {
  Vec3 position = Vec3::Zero();         ///< [m]
  Quat orientation = Quat::Identity();  ///< of unit length
};

/// Moves and turns a pose over `seconds` by a cap held at `counts` (x y z, then about x y z), both in the
/// controller's axes, which do not turn with the pose. Exact for a constant turn.
inline void advance(const std::array<int, 6>& counts, double seconds, SpacenavPose& pose) {
  const Vec3 speed(counts[0], counts[1], counts[2]);
  const Vec3 turn = kTurnSpeedPerCount * seconds * Vec3(counts[3], counts[4], counts[5]);
  pose.position =
      (pose.position + kSpeedPerCount * seconds * speed).cwiseMax(-kSpacenavReach).cwiseMin(kSpacenavReach);
  const double angle = turn.norm();
  if (angle > 0.0)
    pose.orientation = (Quat(Eigen::AngleAxisd(angle, turn / angle)) * pose.orientation).normalized();
}

}  // namespace argil::device::internal
