#include "embed/bent_edges.h"

#include <cmath>

namespace argil::embed {

Vec3 find_bent_middle(const TriangleTree& surface, double level, const Vec3& a, const Vec3& b) {
  constexpr double kOff = 0.02;   // of the edge's length, that its ends may be off
  constexpr double kNear = 0.25;  // of it
  const double length = (b - a).norm();
  const auto distance = [&surface](const Vec3& x, const TriangleTree::Nearest& nearest) {
    return std::abs(surface.compute_winding_number(x)) > 0.5 ? -nearest.distance : nearest.distance;
  };
  const Vec3 middle = 0.5 * (a + b);
  for (const Vec3& end : {a, b}) {
    const TriangleTree::Nearest nearest = surface.find_nearest(end, std::abs(level) + kNear * length);
    if (nearest.triangle < 0 || !(std::abs(distance(end, nearest) - level) < kOff * length)) return middle;
  }
  const TriangleTree::Nearest nearest = surface.find_nearest(middle, std::abs(level) + kNear * length);
  if (nearest.triangle < 0 || !(nearest.distance > 0.0)) return middle;
  const double off = distance(middle, nearest);
  return nearest.point + level / off * (middle - nearest.point);
}

}  // namespace argil::embed
