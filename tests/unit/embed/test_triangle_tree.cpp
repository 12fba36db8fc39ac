// Distances against a loop over all triangles, winding numbers against closed forms.
#include "embed/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "shapes/shapes.h"

namespace argil::embed {
namespace {

Vec3 random_point(Rng& rng) {
  const double x = rng.uniform(-1, 1);
  const double y = rng.uniform(-1, 1);
  return {x, y, rng.uniform(-1, 1)};
}

// Distance by a fine net of points on the triangle.
double compute_distance_by_sampling(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  constexpr int kSteps = 300;
  double smallest = 1e9;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = static_cast<double>(i) / kSteps;
      const double v = static_cast<double>(j) / kSteps;
      smallest = std::min(smallest, (x - (1.0 - u - v) * a - u * b - v * c).norm());
    }
  return smallest;
}

TEST(ClosestPoint, IsNoFartherThanAnySampleAndLiesInTheTriangle) {
  Rng rng(3, "closest");
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random_point(rng);
    const Vec3 b = random_point(rng);
    const Vec3 c = i % 5 == 0 ? Vec3(0.3 * a + 0.7 * b) : random_point(rng);  // every fifth is a mere segment
    const Vec3 x = random_point(rng);
    const ClosestPoint closest = find_closest_point(a, b, c, x);
    EXPECT_NEAR(closest.weights.sum(), 1.0, 1e-12);
    EXPECT_GE(closest.weights.minCoeff(), 0.0);
    EXPECT_NEAR(
        (closest.weights(0) * a + closest.weights(1) * b + closest.weights(2) * c - closest.point).norm(),
        0.0, 1e-12);
    const double sampled = compute_distance_by_sampling(a, b, c, x);
    EXPECT_LE((x - closest.point).norm(), sampled + 1e-12);
    EXPECT_NEAR((x - closest.point).norm(), sampled, 0.02);  // the net's width
  }
  const Vec3 p(1, 2, 3);
  EXPECT_EQ(find_closest_point(p, p, p, Vec3::Zero()).point, p);
}

TEST(TriangleTree, DistanceEqualsALoopOverAllTriangles) {
  const mesh::TriangleMesh skin = shapes::make_shape_skin({shapes::ShapeKind::dinosaur, 1.0}, 3000);
  TriangleTree tree(skin);
  Rng rng(9, "tree");
  Field radius(skin.num_vertices());
  for (Eigen::Index i = 0; i < radius.size(); ++i) radius(i) = rng.uniform(0.0, 0.05);
  tree.set_radius(radius);
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = random_point(rng);
    double smallest = 1e9;
    for (int t = 0; t < skin.num_triangles(); ++t) {
      const Eigen::Vector3i v = skin.triangles.col(t);
      const ClosestPoint closest =
          find_closest_point(skin.vertices.col(v(0)), skin.vertices.col(v(1)), skin.vertices.col(v(2)), x);
      smallest =
          std::min(smallest, (x - closest.point).norm() - closest.weights(0) * radius(v(0)) -
                                 closest.weights(1) * radius(v(1)) - closest.weights(2) * radius(v(2)));
      for (int k = 0; k < 3; ++k)
        smallest = std::min(smallest, (x - skin.vertices.col(v(k))).norm() - radius(v(k)));
    }
    EXPECT_NEAR(tree.compute_distance(x, 1e9), smallest, 1e-15);
    EXPECT_EQ(tree.compute_distance(x, -1.0), -1.0);
  }
}

TEST(SolidAngle, OfAnOctantIsHalfPi) {
  const double angle = compute_solid_angle(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3::Zero());
  EXPECT_NEAR(angle, std::numbers::pi / 2.0, 1e-15);
}

TEST(WindingNumber, IsOneInsideAndZeroOutsideAClosedSurface) {
  const mesh::TriangleMesh skin = shapes::make_shape_skin({shapes::ShapeKind::sphere, 1.0}, 2000);
  const TriangleTree tree(skin);
  Rng rng(4, "winding");
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_point(rng) + Vec3(0, 0, 0.5);
    const double distance = (x - Vec3(0, 0, 0.5)).norm() - 0.5;
    if (std::abs(distance) < 0.02) continue;
    EXPECT_NEAR(tree.compute_winding_number(x), distance < 0.0 ? 1.0 : 0.0, 0.05);  // error of the dipoles
  }
}

TEST(WindingNumber, IsOneHalfInTheMouthOfAnOpenBowl) {
  mesh::TriangleMesh bowl = shapes::make_shape_skin({shapes::ShapeKind::sphere, 1.0}, 2000);
  int kept = 0;
  for (int t = 0; t < bowl.num_triangles(); ++t) {
    double highest = 0.0;
    for (int i = 0; i < 3; ++i) highest = std::max(highest, bowl.vertices(2, bowl.triangles(i, t)));
    if (highest < 0.5) bowl.triangles.col(kept++) = bowl.triangles.col(t);
  }
  bowl.triangles.conservativeResize(3, kept);
  const TriangleTree tree(bowl);
  // Seen from a point of the plane through the rim the bowl fills half of all directions; the rim of whole
  // triangles lies up to one edge, 0.05, lower.
  EXPECT_NEAR(tree.compute_winding_number(Vec3(0, 0, 0.5)), 0.5, 0.06);
  EXPECT_GT(tree.compute_winding_number(Vec3(0, 0, 0.2)), 0.7);
  EXPECT_LT(tree.compute_winding_number(Vec3(0, 0, 0.8)), 0.3);
}

}  // namespace
}  // namespace argil::embed
