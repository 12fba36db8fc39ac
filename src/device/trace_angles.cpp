#include "device/trace_angles.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/check.h"
#include "base/lower_case.h"

namespace argil::device::internal {

std::optional<double> find_angle_unit(AngleUnit unit, std::string_view stated) {
  const std::string word = to_lower_case(stated);
  if (unit == AngleUnit::rad || (unit == AngleUnit::automatic && (word == "rad" || word == "radians")))
    return 1.0;
  if (unit == AngleUnit::deg ||
      (unit == AngleUnit::automatic && (word == "deg" || word == "degrees" || word == "\xC2\xB0")))
    return std::numbers::pi / 180.0;
  return std::nullopt;
}

// About fixed axes the next rotation comes from the left, about the axes as they turn from the right.
Quat turn_by_angles(AngleOrder order, const Vec3& angles) {
  ARGIL_ASSERT(order != AngleOrder::none);
  if (order == AngleOrder::vector) {
    const double angle = angles.norm();
    Quat q(std::cos(0.5 * angle), 0.0, 0.0, 0.0);
    if (angle > 0.0) q.vec() = std::sin(0.5 * angle) / angle * angles;
    return q;
  }
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  const bool is_fixed = order <= AngleOrder::zyx;
  const int first = static_cast<int>(is_fixed ? AngleOrder::xyz : AngleOrder::XYZ);
  Quat q = Quat::Identity();
  for (const int axis : kOrders[static_cast<std::size_t>(static_cast<int>(order) - first)]) {
    const Quat turn(Eigen::AngleAxisd(angles[axis], Vec3::Unit(axis)));
    q = is_fixed ? turn * q : q * turn;
  }
  return q;
}

}  // namespace argil::device::internal
