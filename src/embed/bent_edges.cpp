#include "embed/bent_edges.h"

namespace argil::embed {

Vec3 find_bent_middle(const TriangleTree& surface, const Vec3& a, const Vec3& b) {
  constexpr double kOff = 0.1;    // of the edge's length, that its ends may be off
  constexpr double kNear = 0.25;  // of it
  const double length = (b - a).norm();
  const Vec3 middle = 0.5 * (a + b);
  const TriangleTree::Nearest at_a = surface.find_nearest(a, kOff * length);
  const TriangleTree::Nearest at_b = surface.find_nearest(b, kOff * length);
  const TriangleTree::Nearest nearest = surface.find_nearest(middle, kNear * length);
  if (at_a.triangle < 0 || at_b.triangle < 0 || nearest.triangle < 0) return middle;
  return nearest.point + 0.5 * (a - at_a.point + b - at_b.point);
}

}  // namespace argil::embed
