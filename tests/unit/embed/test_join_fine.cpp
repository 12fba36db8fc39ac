// A surface that is finer than it needs to be: what is dropped was flat, the rest stays where it was.
#include "embed/join_fine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "embed/skin_shape.h"
#include "embed/triangle_tree.h"
#include "shapes/shapes.h"
#include "support/box_skin.h"

namespace argil::embed {
namespace {

mesh::TriangleMesh make_box(int n) {
  return test::make_box_skin(n, Vec3(0.5, -0.2, 0.1), Vec3(0.04, 0.04, 0.02));
}

Field everywhere(const mesh::TriangleMesh& surface, double shortest) {
  return Field::Constant(surface.num_vertices(), shortest);
}

double find_longest(const mesh::TriangleMesh& m) {
  double longest = 0.0;
  for (const auto& t : m.triangles.colwise())
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (m.vertices.col(t(k)) - m.vertices.col(t((k + 1) % 3))).norm());
  return longest;
}

double find_farthest(const mesh::TriangleMesh& from, const mesh::TriangleMesh& surface) {
  const TriangleTree tree(surface);
  double farthest = 0.0;
  for (const auto& x : from.vertices.colwise())
    farthest = std::max(farthest, tree.find_nearest(x, 1.0).distance);
  return farthest;
}

/// Place of each vertex of `some` in `all`, which must be there; −1 where it is not.
std::vector<int> find_places(const Points& some, const Points& all) {
  std::vector<int> places;
  for (const auto& x : some.colwise()) {
    int place = -1;
    for (int v = 0; v < static_cast<int>(all.cols()) && place < 0; ++v)
      if (all.col(v) == x) place = v;
    places.push_back(place);
  }
  return places;
}

TEST(JoinFine, FlatFacesKeepTheirEdgesAndVolume) {
  const mesh::TriangleMesh fine = make_box(32);  // edges of 1.25 mm
  const mesh::TriangleMesh joined = join_fine(fine, everywhere(fine, 0.004));
  EXPECT_LT(joined.num_triangles(), fine.num_triangles() / 4);
  EXPECT_TRUE(is_closed(joined));
  EXPECT_NEAR(compute_skin_volume(joined), 0.04 * 0.04 * 0.02, 1e-9 * 0.04 * 0.04 * 0.02);
  EXPECT_LE(find_longest(joined), 0.008);
  EXPECT_LT(find_farthest(fine, joined), 1e-12);
}

TEST(JoinFine, WhatStaysKeepsPlaceAndOrder) {
  const mesh::TriangleMesh fine = make_box(16);
  const mesh::TriangleMesh joined = join_fine(fine, everywhere(fine, 0.006));
  const std::vector<int> places = find_places(joined.vertices, fine.vertices);
  EXPECT_GE(places.front(), 0);
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
  EXPECT_LT(joined.num_vertices(), fine.num_vertices());
}

/// Facets with their corners on a sphere of radius R, edges up to 2 s, lie (2s)²/(6R) off at most [arc over
/// the circumcircle of a regular triangle], and are allowed s/12.
TEST(JoinFine, ASphereStaysRound) {
  const double radius = 0.05, shortest = 0.005;
  const mesh::TriangleMesh fine = shapes::make_shape_skin({shapes::ShapeKind::sphere, 2.0 * radius}, 20000);
  const mesh::TriangleMesh joined = join_fine(fine, everywhere(fine, shortest));
  EXPECT_LT(joined.num_triangles(), fine.num_triangles() / 2);
  EXPECT_TRUE(is_closed(joined));
  EXPECT_LT(find_farthest(fine, joined), shortest / 12.0);
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  EXPECT_NEAR(compute_skin_volume(joined), volume, 3.0 * shortest / 12.0 / radius * volume);
}

TEST(JoinFine, WhatIsCoarseOrHeldStays) {
  const mesh::TriangleMesh surface = make_box(16);  // edges of 2.5 mm
  EXPECT_EQ(join_fine(surface, everywhere(surface, 0.002)).triangles, surface.triangles);
  Field half = everywhere(surface, 0.006);
  for (int v = 0; v < surface.num_vertices(); ++v)
    if (surface.vertices(0, v) < 0.52) half(v) = 0.0;
  const mesh::TriangleMesh joined = join_fine(surface, half);
  int held = 0, kept = 0;
  const std::vector<int> places = find_places(joined.vertices, surface.vertices);
  for (int v = 0; v < surface.num_vertices(); ++v) {
    if (half(v) > 0.0) continue;
    ++held;
    kept += std::find(places.begin(), places.end(), v) != places.end() ? 1 : 0;
  }
  EXPECT_EQ(kept, held);
  EXPECT_LT(joined.num_vertices(), surface.num_vertices());
}

TEST(JoinFine, VerticesThatNothingUsesGo) {
  mesh::TriangleMesh surface = make_box(4);
  const int used = surface.num_vertices();
  surface.vertices.conservativeResize(3, used + 5);
  surface.vertices.rightCols(5).setConstant(0.3);
  const mesh::TriangleMesh joined = join_fine(surface, everywhere(surface, 0.0));
  EXPECT_EQ(joined.num_vertices(), used);
  EXPECT_EQ(joined.triangles, surface.triangles);
}

}  // namespace
}  // namespace argil::embed
