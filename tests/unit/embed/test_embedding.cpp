// Embedding: partition of unity and linear precision, refusal of points outside, and the barycentric weights
// that Vega FEM published for its turtle.
#include "embed/embedding.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/rng.h"
#include "mesh_files/readers.h"
#include "shapes/shapes.h"
#include "support/shared_data.h"

namespace argil::embed {
namespace {

mesh::TetMesh make_cage_box() {
  return shapes::make_shape_mesh({shapes::ShapeKind::box, 1.0}, 2000);
}

Points make_points_inside(int count) {
  Rng rng(7, "embedding");
  Points points(3, count);
  for (int i = 0; i < count; ++i)
    points.col(i) = Vec3(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(0.0, 1.0));
  return points;
}

TEST(Embedding, WeightsSumToOneLieInTheUnitRangeAndReproduceThePoints) {
  const mesh::TetMesh cage = make_cage_box();
  const Points points = make_points_inside(3000);
  const Embedding embedding = make_embedding(cage, points, "test");
  EXPECT_NEAR((embedding.weights.colwise().sum().array() - 1.0).abs().maxCoeff(), 0.0, 1e-15);
  EXPECT_GE(embedding.weights.minCoeff(), -1e-10);
  EXPECT_LE(embedding.weights.maxCoeff(), 1.0 + 1e-10);
  Points out;
  interpolate_positions(embedding, cage.tets, cage.vertices, out);
  EXPECT_NEAR((out - points).cwiseAbs().maxCoeff(), 0.0, 1e-14);
}

TEST(Embedding, FollowsAnAffineMapOfTheCageExactly) {
  const mesh::TetMesh cage = make_cage_box();
  const Points points = make_points_inside(1000);
  const Embedding embedding = make_embedding(cage, points, "test");
  Mat3 A;
  A << 1.3, -0.4, 0.2, 0.1, 0.7, 0.5, -0.3, 0.2, 1.1;
  const Vec3 b(0.5, -2.0, 3.0);
  const Points moved_cage = (A * cage.vertices).colwise() + b;
  const Points moved_points = (A * points).colwise() + b;
  Points out;
  interpolate_positions(embedding, cage.tets, moved_cage, out);
  EXPECT_NEAR((out - moved_points).cwiseAbs().maxCoeff(), 0.0, 1e-14);
}

TEST(Embedding, FindsEveryVertexOfTheCageInTheLowestTetAroundIt) {
  const mesh::TetMesh cage = make_cage_box();
  const Embedding embedding = make_embedding(cage, cage.vertices, "test");
  for (int v = 0; v < cage.num_vertices(); ++v) {
    int lowest = 0;
    while ((cage.tets.col(lowest).array() != v).all()) ++lowest;
    ASSERT_EQ(embedding.tet[static_cast<std::size_t>(v)], lowest);
  }
}

TEST(Embedding, RefusesPointsOutsideAndSaysWhichHowManyAndHowFar) {
  Points points = make_points_inside(10);
  points.col(4) = Vec3(0.75, 0.0, 0.5);
  points.col(8) = Vec3(0.0, 0.0, -0.5);
  try {
    make_embedding(make_cage_box(), points, "skin.obj");
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "skin.obj: vertex 4 (counted from 0): 2 of 10 vertices lie outside the cage, this one by 0.25 m, the "
        "farthest by 0.5 m; make a cage that encloses the surface with `argil cage`");
  }
  points.col(4)(0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make_embedding(make_cage_box(), points, "skin.obj"), InputError);
}

TEST(Embedding, TetFieldTakesTheValueOfTheContainingTet) {
  const mesh::TetMesh cage = make_cage_box();
  const Points points = make_points_inside(200);
  const Embedding embedding = make_embedding(cage, points, "test");
  Field per_tet(cage.num_tets());
  for (int t = 0; t < cage.num_tets(); ++t) {  // mean height of the tet's corners
    per_tet(t) = 0.0;
    for (int i = 0; i < 4; ++i) per_tet(t) += 0.25 * cage.vertices(2, cage.tets(i, t));
  }
  Field out;
  interpolate_tet_field(embedding, per_tet, out);
  for (int i = 0; i < 200; ++i) EXPECT_NEAR(out(i), points(2, i), 0.2);  // a tet is lower than one cube edge
}

TEST(Embedding, LaterCallsKeepTheMemoryOfTheFirst) {
  const mesh::TetMesh cage = make_cage_box();
  const Embedding embedding = make_embedding(cage, make_points_inside(100), "test");
  Points out;
  interpolate_positions(embedding, cage.tets, cage.vertices, out);
  const double* const data = out.data();
  interpolate_positions(embedding, cage.tets, cage.vertices, out);
  EXPECT_EQ(out.data(), data);
}

TEST(RegionOfInfluence, FallsLinearlyFromOneAtTheToolToZeroAtTheRadius) {
  Points points(3, 4);
  points << 0, 1, 2, 5,  //
      0, 0, 0, 0,        //
      1, 1, 1, 1;
  Field out;
  compute_region_of_influence(points, Vec3(0, 0, 1), 2.0, out);
  EXPECT_DOUBLE_EQ(out(0), 1.0);
  EXPECT_DOUBLE_EQ(out(1), 0.5);
  EXPECT_DOUBLE_EQ(out(2), 0.0);
  EXPECT_DOUBLE_EQ(out(3), 0.0);
}

TEST(Embedding, GivesTheWeightsThatVegaFemPublishedForItsTurtle) {
  ARGIL_NEED_SHARED_DATA("tets/turtle.interp");
  const mesh::TetMesh cage =
      mesh_files::read_tet_mesh(test::shared_data("tets/turtle-volumetric-homogeneous.veg"));
  const Points points = mesh_files::read_triangle_mesh(test::shared_data("tets/turtle.obj")).vertices;
  ASSERT_EQ(cage.num_tets(), 1185);
  ASSERT_EQ(points.cols(), 1961);
  const Embedding embedding = make_embedding(cage, points, "turtle.obj");
  const double box = (cage.vertices.rowwise().maxCoeff() - cage.vertices.rowwise().minCoeff()).maxCoeff();
  std::ifstream in(test::shared_data("tets/turtle.interp"));
  int number = 0;
  int num_same_tet = 0;
  for (int v = 0; v < 1961; ++v) {
    in >> number;
    ASSERT_EQ(number, v);
    Field published = Field::Zero(cage.num_vertices());
    Field ours = Field::Zero(cage.num_vertices());
    for (int i = 0; i < 4; ++i) {
      int vertex = 0;
      double weight = 0.0;
      in >> vertex >> weight;
      published(vertex) = weight;
      const int t = embedding.tet[static_cast<std::size_t>(v)];
      ours(cage.tets(i, t)) = embedding.weights(i, v);
    }
    // Both place the vertex at the same point, up to six printed digits of the weights, …
    EXPECT_NEAR((cage.vertices * (ours - published)).norm(), 0.0, 1e-6 * box) << v;
    // … and a place in a tet has one set of weights; six digits of a coordinate over a height of 0.05 of the
    // box.
    if ((ours - published).cwiseAbs().maxCoeff() < 2e-5) ++num_same_tet;
  }
  EXPECT_TRUE(in.good());
  EXPECT_EQ(num_same_tet, 1961);
}

}  // namespace
}  // namespace argil::embed
