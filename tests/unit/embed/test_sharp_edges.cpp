// Where faces of a surface meet at an angle.
#include "embed/sharp_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapes/shapes.h"
#include "support/box_skin.h"

namespace argil::embed {
namespace {

TEST(SharpEdges, OfABoxAreItsTwelveEdgesAndEightCorners) {
  constexpr int kN = 6;
  const mesh::TriangleMesh box = test::make_box_skin(kN, Vec3(0, 0, 0), Vec3(3, 2, 1));
  const SharpEdges sharp = find_sharp_edges(box);
  EXPECT_EQ(sharp.edges.cols(), 4 * (kN + kN + kN / 2));
  EXPECT_EQ(sharp.corners.size(), 8U);
  double length = 0.0;
  for (const auto& e : sharp.edges.colwise())
    length += (box.vertices.col(e(0)) - box.vertices.col(e(1))).norm();
  EXPECT_NEAR(length, 4.0 * (3.0 + 2.0 + 1.0), 1e-12);
}

TEST(SharpEdges, ASphereHasNone) {
  const SharpEdges sharp = find_sharp_edges(shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.1}, 1280));
  EXPECT_EQ(sharp.edges.cols(), 0);
  EXPECT_TRUE(sharp.corners.empty());
}

TEST(SharpEdges, TheRimOfATopHasNoCorners) {
  constexpr int kSides = 24;
  mesh::TriangleMesh top;  // two cones, base to base
  top.vertices.resize(3, kSides + 2);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    top.vertices.col(i) << std::cos(angle), std::sin(angle), 0.0;
  }
  top.vertices.col(kSides) << 0, 0, 1;
  top.vertices.col(kSides + 1) << 0, 0, -1;
  top.triangles.resize(3, 2 * kSides);
  for (int i = 0; i < kSides; ++i) {
    const int next = (i + 1) % kSides;
    top.triangles.col(2 * i) << i, next, kSides;
    top.triangles.col(2 * i + 1) << next, i, kSides + 1;
  }
  const SharpEdges sharp = find_sharp_edges(top);
  EXPECT_EQ(sharp.edges.cols(), kSides);
  EXPECT_TRUE(sharp.corners.empty());
}

}  // namespace
}  // namespace argil::embed
