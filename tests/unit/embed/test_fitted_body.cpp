// Bodies whose boundary lies on a surface: volume, distances, what is thinner than a cell, surfaces that lack
// something, and what is outside.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "embed/cage.h"
#include "embed/embedding.h"
#include "embed/triangle_tree.h"
#include "mesh_files/readers.h"
#include "shapes/hexahedra.h"
#include "shapes/shapes.h"
#include "support/mesh_measures.h"
#include "support/shared_data.h"

namespace argil::embed {
namespace {

Cage fit(const mesh::TriangleMesh& surface, int target) {
  return make_cage(surface, {target, Fit::surface}, "fitted");
}

/// Sound, of the wanted number, and with a place for every vertex of the surface.
void expect_good_body(const mesh::TriangleMesh& surface, const Cage& body, int target) {
  EXPECT_NEAR(body.mesh.num_tets(), target, 0.15 * target);
  EXPECT_GT(mesh::compute_volumes(body.mesh.vertices, body.mesh.tets).minCoeff(), 0.0);
  const test::AngleRange range = test::compute_dihedral_range(body.mesh);
  EXPECT_GT(range.smallest, 10.0);
  EXPECT_LT(range.largest, 165.0);
  const Triangles boundary = mesh::make_topology(body.mesh).boundary;
  EXPECT_TRUE(test::compute_surface_facts(body.mesh.vertices, boundary).is_manifold);
  const Embedding embedding = make_embedding(body.mesh, surface.vertices, "fitted", kMostBeyondFitted);
  Points places;
  interpolate_positions(embedding, body.mesh.tets, body.mesh.vertices, places);
  EXPECT_LT((places - surface.vertices).cwiseAbs().maxCoeff(), 1e-12);
}

double find_farthest(const Points& points, const mesh::TriangleMesh& surface) {
  const TriangleTree tree(surface);
  double farthest = 0.0;
  for (const auto& x : points.colwise()) farthest = std::max(farthest, tree.compute_distance(x, 1e9));
  return farthest;
}

/// Points all over triangles, each edge in so many parts.
Points sample(const Points& vertices, const Triangles& triangles, int parts) {
  std::vector<Vec3> samples;
  for (const auto& t : triangles.colwise())
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j)
        samples.emplace_back(
            (i * vertices.col(t(0)) + j * vertices.col(t(1)) + (parts - i - j) * vertices.col(t(2))) / parts);
  Points x(3, static_cast<Eigen::Index>(samples.size()));
  for (Eigen::Index k = 0; k < x.cols(); ++k) x.col(k) = samples[static_cast<std::size_t>(k)];
  return x;
}

/// An octahedron of 6 cm, whose faces lie along the lattice's: 1666 tets fall into a leap.
TEST(FittedBody, TakesTheNearestNumberThatALatticeHasAndSaysSo) {
  mesh::TriangleMesh gem;
  gem.vertices.resize(3, 6);
  gem.vertices << 0, 0.03, 0, -0.03, 0, 0, 0, 0, 0.03, 0, -0.03, 0, 0.06, 0.03, 0.03, 0.03, 0.03, 0;
  gem.triangles.resize(3, 8);
  gem.triangles << 0, 0, 0, 0, 5, 5, 5, 5, 1, 2, 3, 4, 2, 3, 4, 1, 2, 3, 4, 1, 1, 2, 3, 4;
  const Cage body = fit(gem, 1666);
  EXPECT_EQ(body.report.wanted_tets, 1666);
  EXPECT_GT(std::abs(body.mesh.num_tets() - 1666), 0.15 * 1666);
  EXPECT_LT(std::abs(body.mesh.num_tets() - 1666), 0.5 * 1666);
  EXPECT_NE(describe(body.report).find(" (for the 1666 wanted: "), std::string::npos);
  EXPECT_GT(mesh::compute_volumes(body.mesh.vertices, body.mesh.tets).minCoeff(), 0.0);
  EXPECT_NEAR(mesh::compute_volumes(body.mesh.vertices, body.mesh.tets).sum(), 3.6e-5, 0.02 * 3.6e-5);
  const Cage plain = fit(gem, 1500);
  EXPECT_EQ(plain.report.wanted_tets, 0);
  EXPECT_NEAR(plain.mesh.num_tets(), 1500, 0.15 * 1500);
}

TEST(FittedBody, HasTheVolumeOfItsSurfaceAndLiesOnIt) {
  for (const shapes::ShapeKind kind : {shapes::ShapeKind::sphere, shapes::ShapeKind::cylinder,
                                       shapes::ShapeKind::box, shapes::ShapeKind::figure})
    for (const int target : {10000, 40000}) {
      SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(kind) << ", target " << target);
      const mesh::TriangleMesh surface = shapes::make_shape_skin({kind, 0.2}, 5000);
      const Cage body = fit(surface, target);
      expect_good_body(surface, body, target);
      const double wanted = test::compute_enclosed_volume(surface.vertices, surface.triangles);
      const double volume = mesh::compute_volumes(body.mesh.vertices, body.mesh.tets).sum();
      EXPECT_NEAR(volume, wanted, 0.01 * wanted);
      EXPECT_NEAR(body.report.volume_ratio, volume / wanted, 1e-9);
      EXPECT_LT(body.report.median_distance, 0.1 * body.report.cell_size);
      // Sharp edges to half a cell, or a little more at corners.
      EXPECT_LT(body.report.max_skin_distance, 0.6 * body.report.cell_size);
      const Triangles boundary = mesh::make_topology(body.mesh).boundary;
      EXPECT_NEAR(
          body.report.max_skin_distance,
          find_farthest(sample(surface.vertices, surface.triangles, 6), {body.mesh.vertices, boundary}),
          0.15 * body.report.max_skin_distance + 1e-6);
    }
}

TEST(FittedBody, IsTheSameTwice) {
  const mesh::TriangleMesh surface = shapes::make_shape_skin({shapes::ShapeKind::figure, 0.2}, 3000);
  EXPECT_EQ(test::hash_mesh(fit(surface, 3000).mesh), test::hash_mesh(fit(surface, 3000).mesh));
}

TEST(FittedBody, KeepsAPlateThinnerThanACell) {
  mesh::TriangleMesh plate =
      shapes::extract_boundary(shapes::make_box_hexahedra(Vec3(1.0, 1.0, 0.02), {20, 20, 1}));
  const Cage body = fit(plate, 2000);
  ASSERT_LT(0.02, 0.5 * body.report.cell_size);
  expect_good_body(plate, body, 2000);
  EXPECT_EQ(test::count_components(body.mesh), 1);
  EXPECT_LT(body.report.max_distance, body.report.cell_size);
}

TEST(FittedBody, TakesTurnedFacesHolesAndSeveralPartsAsTheyCome) {
  const mesh::TriangleMesh ball = shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.1}, 2000);
  const double volume = test::compute_enclosed_volume(ball.vertices, ball.triangles);
  const auto expect_volume = [&](const mesh::TriangleMesh& surface, double wanted, double tolerance) {
    const Cage body = fit(surface, 4000);
    expect_good_body(surface, body, 4000);
    EXPECT_NEAR(mesh::compute_volumes(body.mesh.vertices, body.mesh.tets).sum(), wanted, tolerance * wanted);
    return test::count_components(body.mesh);
  };
  mesh::TriangleMesh turned = ball;
  turned.triangles.row(0).swap(turned.triangles.row(1));
  expect_volume(turned, volume, 0.01);

  mesh::TriangleMesh pair = ball;
  pair.vertices.conservativeResize(3, 2 * ball.num_vertices());
  pair.vertices.rightCols(ball.num_vertices()) = ball.vertices.colwise() + Vec3(0.2, 0.0, 0.0);
  pair.triangles.conservativeResize(3, 2 * ball.num_triangles());
  pair.triangles.rightCols(ball.num_triangles()) = ball.triangles.array() + ball.num_vertices();
  EXPECT_EQ(expect_volume(pair, 2.0 * volume, 0.01), 2);

  mesh::TriangleMesh holed =
      ball;  // a cap of a fortieth of its area is missing; not closed, no volume to meet
  int kept = 0;
  for (int t = 0; t < ball.num_triangles(); ++t)
    if (ball.vertices(2, ball.triangles(0, t)) < 0.0975) holed.triangles.col(kept++) = ball.triangles.col(t);
  holed.triangles.conservativeResize(3, kept);
  expect_volume(holed, volume, 0.03);
}

TEST(FittedBody, OfASheetWithoutThicknessEnclosesIt) {
  mesh::TriangleMesh sheet;
  sheet.vertices.resize(3, 4);
  sheet.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,                //
      0, 0, 0, 0;
  sheet.triangles.resize(3, 2);
  sheet.triangles << 0, 0,  //
      1, 2,                 //
      2, 3;
  const Cage body = fit(sheet, 2000);
  EXPECT_EQ(body.report.enclosed_vertices, 4);
  EXPECT_EQ(body.report.volume_ratio, 0.0);
  // What is printed is what is measured.
  EXPECT_NEAR(body.report.max_distance, find_farthest(body.mesh.vertices, sheet), 1e-12);
}

// The faces of an octahedron are far larger than cells: nothing of them is near a vertex.
TEST(FittedBody, TellsDistancesAsTheyAreAllOverBothSurfaces) {
  mesh::TriangleMesh gem;
  gem.vertices.resize(3, 6);
  gem.vertices << 1, -1, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,              //
      0, 0, 0, 0, 1, -1;
  gem.triangles.resize(3, 8);
  gem.triangles << 0, 2, 1, 3, 2, 1, 3, 0,  //
      2, 1, 3, 0, 0, 2, 1, 3,               //
      4, 4, 4, 4, 5, 5, 5, 5;
  for (const Fit how : {Fit::surface, Fit::enclose}) {
    CageOptions options;
    options.target_tets = 4000;
    options.fit = how;
    const Cage body = make_cage(gem, options, "gem");
    const Triangles boundary = mesh::make_topology(body.mesh).boundary;
    const double off_surface = find_farthest(sample(body.mesh.vertices, boundary, 20), gem);
    const double off_boundary =
        find_farthest(sample(gem.vertices, gem.triangles, 100), {body.mesh.vertices, boundary});
    EXPECT_NEAR(body.report.max_distance, off_surface, 0.15 * off_surface);
    EXPECT_NEAR(body.report.max_skin_distance, off_boundary, 0.15 * off_boundary);
  }
}

TEST(FittedBody, IsWithinTwoPercentOfAStandingFigureFromElsewhere) {
  ARGIL_NEED_SHARED_DATA("surface/Animated_Human.obj");
  const mesh::TriangleMesh surface =
      mesh_files::read_triangle_mesh(test::shared_data("surface/Animated_Human.obj"));
  const Cage body = fit(surface, 10000);
  expect_good_body(surface, body, 10000);
  EXPECT_NEAR(body.report.volume_ratio, 1.0, 0.02);
}

TEST(FittedBody, CarriesWhatIsOutsideByAnAffineMapExactly) {
  const mesh::TriangleMesh surface = shapes::make_shape_skin({shapes::ShapeKind::figure, 0.2}, 3000);
  const Cage body = fit(surface, 3000);
  EXPECT_LT(body.report.enclosed_vertices, surface.num_vertices());
  const Embedding embedding = make_embedding(body.mesh, surface.vertices, "fitted", kMostBeyondFitted);
  Mat3 A;
  A << 1.1, 0.2, 0.0, -0.1, 0.9, 0.3, 0.0, 0.1, 1.2;
  Points places;
  interpolate_positions(embedding, body.mesh.tets, Points(A * body.mesh.vertices), places);
  EXPECT_LT((places - A * surface.vertices).cwiseAbs().maxCoeff(), 1e-13);
}

}  // namespace
}  // namespace argil::embed
