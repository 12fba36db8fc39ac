// Signed distances against slow references: a tapered capsule is the union of the spheres along its axis.
#include "shapes/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/rng.h"

namespace argil::shapes {
namespace {

Vec3 random_point(Rng& rng, double extent) {
  const double x = rng.uniform(-extent, extent);
  const double y = rng.uniform(-extent, extent);
  return {x, y, rng.uniform(-extent, extent)};
}

TEST(TaperedCapsule, DistanceIsTheSmallestOverAllSpheresOnTheAxis) {
  Rng rng(11, "capsule");
  for (int i = 0; i < 200; ++i) {
    const TaperedCapsule capsule = {random_point(rng, 1), random_point(rng, 1), rng.uniform(0.01, 0.2),
                                    rng.uniform(0.01, 0.2)};
    if ((capsule.b - capsule.a).norm() < 0.25) continue;
    const Vec3 x = random_point(rng, 1.5);
    const auto to_sphere = [&](double t) {
      return (x - (capsule.a + t * (capsule.b - capsule.a))).norm() -
             (capsule.radius_a + t * (capsule.radius_b - capsule.radius_a));
    };
    double nearest = 1e9;
    constexpr int kSamples =
        20000;  // misses the minimum of a convex function by less than (length/samples)²/distance
    for (int s = 0; s <= kSamples; ++s)
      nearest = std::min(nearest, to_sphere(static_cast<double>(s) / kSamples));
    const double distance = compute_distance(capsule, x);
    if (distance < 0.0) continue;  // inside, the union's function is not a distance
    EXPECT_NEAR(distance, nearest, 1e-6);
  }
}

TEST(Ellipsoid, ValueIsZeroOnTheSurfaceWithUnitSlopeAcrossIt) {
  Ellipsoid ellipsoid;
  ellipsoid.centre = Vec3(0.1, 0.2, 0.3);
  ellipsoid.radii = Vec3(0.5, 0.3, 0.2);
  ellipsoid.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Rng rng(5, "ellipsoid");
  for (int i = 0; i < 50; ++i) {
    const Vec3 direction = random_point(rng, 1).normalized();
    const Vec3 x = ellipsoid.centre + ellipsoid.axes * ellipsoid.radii.cwiseProduct(direction);
    const Vec3 normal = (ellipsoid.axes * direction.cwiseQuotient(ellipsoid.radii)).normalized();
    EXPECT_NEAR(compute_distance(ellipsoid, x), 0.0, 1e-15);
    const double step = 1e-6;
    const double slope =
        (compute_distance(ellipsoid, x + step * normal) - compute_distance(ellipsoid, x - step * normal)) /
        (2 * step);
    EXPECT_NEAR(slope, 1.0, 1e-6);  // central difference: O(step²) and round-off/step
  }
  EXPECT_LT(compute_distance(ellipsoid, ellipsoid.centre), 0.0);
}

TEST(SmoothMin, SwellsByAQuarterWidthWhereBothAreEqualAndLeavesFarValuesAlone) {
  EXPECT_DOUBLE_EQ(smooth_min(0.3, 0.3, 0.2), 0.3 - 0.05);
  EXPECT_DOUBLE_EQ(smooth_min(0.1, 0.5, 0.2), 0.1);
  EXPECT_DOUBLE_EQ(smooth_min(0.5, 0.1, 0.2), 0.1);
}

}  // namespace
}  // namespace argil::shapes
