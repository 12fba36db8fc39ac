#pragma once

// Orientations that a recording gives by angles.

#include <optional>
#include <string_view>

#include "device/trace.h"

namespace argil::device::internal {

/// Radians per unit: by the key, else by the unit that the columns' names say ("deg", "rad"). Nothing where
/// neither says one that is known.
std::optional<double> find_angle_unit(AngleUnit unit, std::string_view stated);

/// The rotation of angles about x, y and z [rad], of an order that is given.
Quat turn_by_angles(AngleOrder order, const Vec3& angles);

}  // namespace argil::device::internal
