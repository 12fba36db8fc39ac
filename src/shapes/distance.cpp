#include "shapes/distance.h"

#include <algorithm>
#include <cmath>

namespace argil::shapes {

// In the half plane through the axis, s along it and r across: the cone's side is a straight line that leans
// by sin = (radius_a − radius_b)/|b − a|. Its normal through x tells which of the three pieces is nearest.
double compute_distance(const TaperedCapsule& capsule, const Vec3& x) {
  const Vec3 axis = capsule.b - capsule.a;
  const double length = axis.norm();
  const Vec3 from_a = x - capsule.a;
  const double s = from_a.dot(axis) / length;
  const double r = std::sqrt(std::max(0.0, from_a.squaredNorm() - s * s));
  const double lean = (capsule.radius_a - capsule.radius_b) / length;
  const double upright = std::sqrt(1.0 - lean * lean);
  const double along_side = s * upright - r * lean;  // from the cone's foot at a, along its side
  if (along_side <= 0.0) return from_a.norm() - capsule.radius_a;
  if (along_side >= length * upright) return (x - capsule.b).norm() - capsule.radius_b;
  return r * upright + s * lean - capsule.radius_a;
}

double compute_distance(const Ellipsoid& ellipsoid, const Vec3& x) {
  const Vec3 local = ellipsoid.axes.transpose() * (x - ellipsoid.centre);
  const Vec3 q = local.cwiseQuotient(ellipsoid.radii);
  const double level = q.norm();
  const double slope = q.cwiseQuotient(ellipsoid.radii).norm();  // |q| times the gradient of |q|
  if (!(slope > 0.0)) return -ellipsoid.radii.minCoeff();        // the centre
  return level * (level - 1.0) / slope;
}

double smooth_min(double a, double b, double k) {
  const double h = std::max(1.0 - std::abs(a - b) / k, 0.0);
  return std::min(a, b) - 0.25 * h * h * k;
}

}  // namespace argil::shapes
