// How much of the body's surface lies inside the tool.
#include <gtest/gtest.h>

#include <numbers>

#include "scenes.h"

namespace argil::contact {
namespace {

using test::kR;
using test::make_flat_slab;
using test::Scene;

TEST(TouchedArea, TendsToTheCircleOfASphereInAPlane) {
  const double d = 0.001;
  const double exact = std::numbers::pi * (2.0 * kR * d - d * d);
  double last = 0.0;
  for (const int level : {2, 3, 4}) {
    Scene scene(make_flat_slab(20), make_sphere_tool(kR, level), {0.0013, 0.0007, kR + 1e-4});
    scene.move(Vec3(0.0013, 0.0007, kR - d));
    double area = 0.0;
    for (const double a : scene.contacts.touched_area) area += a;
    const double error = 1.0 - area / exact;
    EXPECT_GT(error, 0.0) << level;  // the tool is inscribed in its sphere
    if (level > 2) {
      EXPECT_GT(last / error, 2.5) << level;  // second order in the facets: about 4, uneven at the rim
    }
    last = error;
    EXPECT_TRUE(
        std::is_sorted(scene.contacts.touched_triangle.begin(), scene.contacts.touched_triangle.end()));
  }
  EXPECT_LT(last, 0.01);
}

TEST(TouchedArea, OfTwoBallsInOneTriangleIsTheSumOfTheirs) {
  constexpr double kApart = 0.02;
  const Vec3 place(-0.003, -0.012, kR + 1e-4);  // of the first; both over one triangle
  const auto measure = [&](const mesh::TriangleMesh& tool) {
    Scene scene(make_flat_slab(1, 0.05), tool, place);
    scene.move(place - Vec3(0, 0, 0.0021));
    double area = 0.0;
    for (const double a : scene.contacts.touched_area) area += a;
    return area;
  };
  const mesh::TriangleMesh ball = make_sphere_tool(kR, 3);
  const double of_two = measure(test::make_pair(ball, ball, {kApart, 0, 0}));
  EXPECT_NEAR(of_two, 2.0 * measure(ball), 0.05 * of_two);  // by points, as for any shape that is not convex
}

TEST(TouchedArea, IsNeverMoreThanTheTrianglesAndOnlyWhenAskedFor) {
  Scene scene(make_flat_slab(), make_sphere_tool(kR, 2), {0.0013, 0.0007, kR + 1e-4});
  scene.contacts.with_touched = false;
  scene.move(Vec3(0.0013, 0.0007, kR - 0.003));
  EXPECT_TRUE(scene.contacts.touched_triangle.empty());
  scene.contacts.with_touched = true;
  scene.move(Vec3(0.0013, 0.0007, kR - 0.003));
  ASSERT_FALSE(scene.contacts.touched_triangle.empty());
  bool is_any_full = false;
  for (const double area : scene.contacts.touched_area) {
    EXPECT_LE(area, 0.5 * 0.005 * 0.005 * (1 + 1e-12));
    is_any_full = is_any_full || area > 0.5 * 0.005 * 0.005 * (1 - 1e-12);
  }
  EXPECT_TRUE(is_any_full);
}

}  // namespace
}  // namespace argil::contact
