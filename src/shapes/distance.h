#pragma once

#include "base/types.h"

namespace argil::shapes {

/// Two spheres and the cone that touches both: a limb.
struct TaperedCapsule {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double radius_a = 0.0;
  double radius_b = 0.0;
};

/// Signed distance, negative inside; exact. Requires |b − a| > |radius_a − radius_b|.
double compute_distance(const TaperedCapsule& capsule, const Vec3& x);

/// Ellipsoid with half axes `radii` along the columns of `axes`.
struct Ellipsoid {
  Vec3 centre = Vec3::Zero();
  Vec3 radii = Vec3::Ones();
  Mat3 axes = Mat3::Identity();
};

/// |q|(|q| − 1)/|∇|q||·… of the scaled place q: zero on the ellipsoid, slope 1 across it, no exact distance
/// away.
double compute_distance(const Ellipsoid& ellipsoid, const Vec3& x);

/// Minimum of two distances whose crease is rounded over a width k [m]: min(a, b) − h²k/4, h = max(1 −
/// |a−b|/k, 0).
double smooth_min(double a, double b, double k);

}  // namespace argil::shapes
