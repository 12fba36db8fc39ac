// A body that follows a surface roughly is laid on it, and its tets keep their shape.
#include "embed/lay_on_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <set>

#include "embed/cage.h"
#include "embed/skin_shape.h"
#include "embed/triangle_tree.h"
#include "mesh/quality.h"
#include "shapes/shapes.h"
#include "support/box_skin.h"

namespace argil::embed {
namespace {

double find_worst(const mesh::TetMesh& m) {
  double worst = 1.0;
  for (const auto& t : m.tets.colwise())
    worst = std::min(worst, mesh::compute_shape({m.vertices.col(t(0)), m.vertices.col(t(1)),
                                                 m.vertices.col(t(2)), m.vertices.col(t(3))}));
  return worst;
}

/// Largest distance of the boundary's vertices from a surface.
double find_farthest(const mesh::TetMesh& m, const mesh::Topology& topology,
                     const mesh::TriangleMesh& surface) {
  const TriangleTree tree(surface);
  double farthest = 0.0;
  for (const int v : topology.boundary.reshaped())
    farthest = std::max(farthest, tree.find_nearest(m.vertices.col(v), 1.0).distance);
  return farthest;
}

TEST(LayOnSurface, ABallThatIsTooLargeComesToLieOnTheSphere) {
  const mesh::TriangleMesh sphere = shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.1}, 5000);
  mesh::TetMesh ball = shapes::make_shape_mesh({shapes::ShapeKind::sphere, 0.1}, 2000);
  const Vec3 middle(0, 0, 0.05);
  ball.vertices = (1.1 * (ball.vertices.colwise() - middle)).colwise() + middle;
  const mesh::Topology topology = mesh::make_topology(ball);
  const double worst = find_worst(ball);
  ASSERT_GT(find_farthest(ball, topology, sphere), 4e-3);
  lay_on_surface(sphere, topology, false, ball);
  // Of facets of edge h vertices lie outside by about h²/12R, so that their middles lie as far inside.
  EXPECT_LT(find_farthest(ball, topology, sphere), 5e-4);
  EXPECT_GE(find_worst(ball), std::min(worst, 0.25));
  EXPECT_NEAR(compute_skin_volume({ball.vertices, topology.boundary}), std::numbers::pi / 6.0 * 1e-3,
              0.003 * std::numbers::pi / 6.0 * 1e-3);
}

/// A block whose top is pressed in where a ball of radius 12 mm stands 6 mm deep.
mesh::TriangleMesh press_ball_into(mesh::TriangleMesh block, double top) {
  const Vec3 middle(0, 0, top + 0.006);
  for (auto x : block.vertices.colwise())
    if ((x - middle).norm() < 0.012) x = middle + 0.012 * (x - middle).normalized();
  return block;
}

TEST(DrawToSurface, AFlatTopFollowsADentThatIsDeeperThanItsCells) {
  const Vec3 size(0.06, 0.06, 0.03);
  const mesh::TriangleMesh flat = test::make_box_skin(60, Vec3(0, 0, 0.5 * size.z()) - 0.5 * size, size);
  const mesh::TriangleMesh dented = press_ball_into(flat, size.z());
  const mesh::TetMesh whole = make_cage(flat, {20000, Fit::surface}, "block").mesh;
  const mesh::Topology topology = mesh::make_topology(whole);
  ASSERT_GT(find_farthest(whole, topology, dented), 4e-3);
  mesh::TetMesh laid = whole, drawn = whole;
  lay_on_surface(dented, topology, false, laid);
  draw_to_surface(dented, topology, drawn);
  EXPECT_GE(find_worst(drawn), std::min(find_worst(whole), 0.25));
  lay_on_surface(dented, topology, false, drawn);
  constexpr double kCell = 3.6e-3;  // the edge of a regular tet of the mean volume
  EXPECT_LT(find_farthest(drawn, topology, dented), kCell / 3.0);
  EXPECT_LT(2.0 * find_farthest(drawn, topology, dented), find_farthest(laid, topology, dented));
}

TEST(DrawToSurface, ABodyThatLiesOnItStaysAsItIs) {
  const mesh::TriangleMesh block = test::make_box_skin(12, Vec3(0, 0, 0), Vec3(0.1, 0.06, 0.04));
  mesh::TetMesh body = make_cage(block, {3000, Fit::surface}, "block").mesh;
  const Points before = body.vertices;
  draw_to_surface(block, mesh::make_topology(body), body);
  EXPECT_LT((body.vertices - before).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(LayOnSurface, APlateThinnerThanACellIsNoThickerThanItIs) {
  const Vec3 size(0.06, 0.06, 0.003);
  const mesh::TriangleMesh plate = test::make_box_skin(20, Vec3(0, 0, 0), size);
  const Cage cage = make_cage(plate, {1500, Fit::surface}, "plate");
  ASSERT_GT(cage.report.cell_size, 0.003);
  EXPECT_LT(find_farthest(cage.mesh, mesh::make_topology(cage.mesh), plate), 0.1 * cage.report.cell_size);
  EXPECT_NEAR(mesh::compute_volumes(cage.mesh.vertices, cage.mesh.tets).sum(), size.prod(),
              0.02 * size.prod());
  EXPECT_GT(mesh::compute_quality(cage.mesh).min_dihedral_degrees, 10.0);
}

TEST(LayOnSurface, SharpEdgesOfATurnedBlockAreKept) {
  const Vec3 size(0.1, 0.06, 0.04);
  mesh::TriangleMesh block = test::make_box_skin(12, -0.5 * size, size);
  block.vertices =
      (Eigen::AngleAxisd(0.3, Vec3::UnitX()) * Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))
          .toRotationMatrix() *
      block.vertices;
  const Cage cage = make_cage(block, {10000, Fit::surface}, "block");
  const double cell = cage.report.cell_size;
  const TriangleTree boundary({cage.mesh.vertices, mesh::make_topology(cage.mesh).boundary});
  for (const auto& x : block.vertices.colwise())
    EXPECT_LT(boundary.find_nearest(x, 1.0).distance, 0.5 * cell);
  EXPECT_LT(cage.report.median_distance, 0.01 * cell);
  EXPECT_NEAR(mesh::compute_volumes(cage.mesh.vertices, cage.mesh.tets).sum(), size.prod(),
              1e-3 * size.prod());
  EXPECT_GT(mesh::compute_quality(cage.mesh).min_dihedral_degrees, 10.0);
}

TEST(MatchVolume, ABallThatIsTooSmallGetsTheWantedOne) {
  mesh::TetMesh ball = shapes::make_shape_mesh({shapes::ShapeKind::sphere, 0.1}, 2000);
  const mesh::Topology topology = mesh::make_topology(ball);
  const double wanted = std::numbers::pi / 6.0 * 1e-3;
  ball.vertices *= 0.99;
  ASSERT_LT(mesh::compute_volumes(ball.vertices, ball.tets).sum(), 0.98 * wanted);
  match_volume(wanted, topology, ball);
  EXPECT_NEAR(mesh::compute_volumes(ball.vertices, ball.tets).sum(), wanted, 2e-4 * wanted);
}

}  // namespace
}  // namespace argil::embed
