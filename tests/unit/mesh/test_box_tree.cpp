// Boxes in boxes: what they find against a loop over all triangles.
#include "mesh/box_tree.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/rng.h"

namespace argil::mesh {
namespace {

struct Nothing {};
using Tree = BoxTree<Nothing>;

/// Small triangles in a cube of edge 1.
Points make_triangle_soup(int num_triangles, Triangles& triangles) {
  Rng rng(11);
  Points x(3, 3 * num_triangles);
  triangles.resize(3, num_triangles);
  for (int t = 0; t < num_triangles; ++t) {
    const Vec3 centre(rng.uniform(), rng.uniform(), rng.uniform());
    for (int k = 0; k < 3; ++k) {
      triangles(k, t) = 3 * t + k;
      x.col(3 * t + k) = centre + 0.02 * Vec3(rng.uniform(), rng.uniform(), rng.uniform());
    }
  }
  return x;
}

Box make_box(const Points& x, const Triangles& triangles, int t) {
  Box box;
  for (int k = 0; k < 3; ++k) box.include(Vec3(x.col(triangles(k, t))));
  return box;
}

Tree make_tree(const Points& x, const Triangles& triangles) {
  return {compute_centroids(x, triangles), [&](Tree::Node& node, std::span<const int> below) {
            for (const int t : below) node.box.include(make_box(x, triangles, t));
          }};
}

TEST(BoxTree, HasEveryTriangleInOneLeafAndChildrenAfterTheirParent) {
  for (const int n : {0, 1, 4, 5, 9, 300}) {
    Triangles triangles;
    const Points x = make_triangle_soup(n, triangles);
    const Tree tree = make_tree(x, triangles);
    EXPECT_EQ(tree.is_empty(), n == 0);
    std::vector<int> seen;
    for (int i = 0; i < static_cast<int>(tree.nodes().size()); ++i) {
      const Tree::Node& node = tree.node(i);
      if (node.is_leaf()) {
        for (const int t : tree.triangles_of(node)) seen.push_back(t);
      }
      EXPECT_TRUE(node.is_leaf() || tree.is_empty() || node.first > i) << i;
    }
    std::sort(seen.begin(), seen.end());
    std::vector<int> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(seen, all);
  }
}

TEST(BoxTree, FindsTheTrianglesWhoseBoxesOverlap) {
  Triangles triangles;
  const Points x = make_triangle_soup(300, triangles);
  const Tree tree = make_tree(x, triangles);
  Box query;
  query.include(Vec3(0.2, 0.3, 0.1));
  query.include(Vec3(0.6, 0.5, 0.4));
  std::vector<int> found, expected;
  tree.descend([&](int i) { return tree.node(i).box.overlaps(query); },
               [&](int i) {
                 for (const int t : tree.triangles_of(tree.node(i)))
                   if (make_box(x, triangles, t).overlaps(query)) found.push_back(t);
               });
  for (int t = 0; t < 300; ++t)
    if (make_box(x, triangles, t).overlaps(query)) expected.push_back(t);
  std::sort(found.begin(), found.end());
  EXPECT_GT(expected.size(), 5u);
  EXPECT_EQ(found, expected);
}

TEST(BoxTree, FindsTheNearestBoxOfATriangleAndLeavesOutMost) {
  Triangles triangles;
  const Points x = make_triangle_soup(300, triangles);
  const Tree tree = make_tree(x, triangles);
  Rng rng(12);
  for (int i = 0; i < 50; ++i) {
    const Vec3 p(rng.uniform(), rng.uniform(), rng.uniform());
    double least = std::numeric_limits<double>::infinity(), expected = least;
    int num_measured = 0, num_ended = 0;
    tree.descend_by_distance([&](int n) { return tree.node(n).box.squared_distance(p); },
                             [&](double distance) { return distance < least; },
                             [&](int n) {
                               for (const int t : tree.triangles_of(tree.node(n))) {
                                 least = std::min(least, make_box(x, triangles, t).squared_distance(p));
                                 ++num_measured;
                               }
                             },
                             [&](int) { ++num_ended; });
    for (int t = 0; t < 300; ++t)
      expected = std::min(expected, make_box(x, triangles, t).squared_distance(p));
    EXPECT_EQ(least, expected);
    EXPECT_LT(num_measured, 150);
    EXPECT_GT(num_ended, 0);
  }
}

TEST(Box, DistanceIsThatOfTheNearestPlace) {
  Box box;
  box.include(Vec3(0, 0, 0));
  box.include(Vec3(1, 2, 3));
  EXPECT_EQ(box.distance(Vec3(0.5, 1, 2)), 0.0);
  EXPECT_EQ(box.distance(Vec3(4, 6, 2)), 5.0);
  EXPECT_EQ(box.squared_distance(Vec3(4, 6, 2)), 25.0);
  EXPECT_EQ(box.squared_distance(Vec3(4, 6, 2), 1.0), 13.0);
  EXPECT_TRUE(box.overlaps(box.grown(-0.4)));
}

}  // namespace
}  // namespace argil::mesh
