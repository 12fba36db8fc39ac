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
  lay_on_surface(sphere, topology, ball);
  // Of facets of edge h vertices lie outside by about h²/12R, so that their middles lie as far inside.
  EXPECT_LT(find_farthest(ball, topology, sphere), 5e-4);
  EXPECT_GE(find_worst(ball), std::min(worst, 0.25));
  EXPECT_NEAR(compute_skin_volume({ball.vertices, topology.boundary}), std::numbers::pi / 6.0 * 1e-3,
              0.003 * std::numbers::pi / 6.0 * 1e-3);
}

TEST(LayOnSurface, APlateThinnerThanACellIsNoThickerThanItIs) {
  const Vec3 size(0.06, 0.06, 0.003);
  const mesh::TriangleMesh plate = test::make_box_skin(20, Vec3(0, 0, 0), size);
  Cage cage = make_cage(plate, {1500, Fit::surface}, "plate");
  ASSERT_GT(cage.report.cell_size, 0.003);
  const mesh::Topology topology = mesh::make_topology(cage.mesh);
  const double before = find_farthest(cage.mesh, topology, plate);
  lay_on_surface(plate, topology, cage.mesh);
  EXPECT_LT(find_farthest(cage.mesh, topology, plate), 0.5 * before);
  EXPECT_NEAR(compute_skin_volume({cage.mesh.vertices, topology.boundary}), size.prod(), 0.1 * size.prod());
  EXPECT_GT(mesh::compute_volumes(cage.mesh.vertices, cage.mesh.tets).minCoeff(), 0.0);
}

}  // namespace
}  // namespace argil::embed
