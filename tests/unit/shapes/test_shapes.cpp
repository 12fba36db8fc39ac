// The bodies that argil makes: counts, closed-form volumes, symmetry, closed skins.
#include "shapes/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "mesh/sliver.h"
#include "support/mesh_measures.h"

namespace argil::shapes {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::array<ShapeKind, 5> kAllShapes = {ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::box,
                                                 ShapeKind::dinosaur, ShapeKind::figure};

TEST(MakeShapeMesh, CountComesWithinFifteenPercentAndTetsAreSound) {
  for (const ShapeKind kind : kAllShapes)
    for (const int target : {600, 2000, 5000, 10000, 40000}) {
      SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(kind) << ", target " << target);
      const mesh::TetMesh mesh = make_shape_mesh({kind, 0.1}, target);
      EXPECT_NEAR(mesh.num_tets(), target, 0.15 * target);
      EXPECT_GT(mesh::compute_volumes(mesh.vertices, mesh.tets).minCoeff(), 0.0);
      EXPECT_EQ(test::count_components(mesh), 1);
      const test::SurfaceFacts facts =
          test::compute_surface_facts(mesh.vertices, mesh::make_topology(mesh).boundary);
      EXPECT_TRUE(facts.is_manifold);
      const test::AngleRange range = test::compute_dihedral_range(mesh);
      EXPECT_GT(range.smallest, 10.0);  // see test_implicit.cpp
      EXPECT_LT(range.largest, 165.0);
    }
}

TEST(HalvedShape, HasItsNewVerticesOnTheTrueSurfaceAndSoundTets) {
  for (const ShapeKind kind : kAllShapes) {
    SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(kind));
    const Shape shape{kind, 0.1};
    const mesh::TetMesh coarse = make_shape_mesh(shape, 2000);
    const mesh::Topology topology = mesh::make_topology(coarse);
    const Vec3 place = coarse.vertices.col(topology.boundary(0, topology.boundary.cols() / 2));
    mesh::BisectedMesh fine = mesh::bisect(
        coarse, [&](const Vec3& x) { return 0.0005 + 0.3 * (x - place).norm(); }, 1'000'000,
        make_boundary_point(shape));
    ASSERT_GT(fine.mesh.num_tets(), coarse.num_tets() + 1000);
    const test::AngleRange range = test::compute_dihedral_range(fine.mesh);
    EXPECT_GT(range.smallest, 10.0);
    EXPECT_LT(range.largest, 165.0);
    const ImplicitSurface surface = make_implicit_shape(shape);
    int num_off = 0;
    int num_new = 0;
    const Triangles boundary = mesh::make_topology(fine.mesh).boundary;
    for (const int v : boundary.reshaped()) {
      if (v < coarse.num_vertices()) continue;
      ++num_new;
      if (std::abs(surface.value(fine.mesh.vertices.col(v))) > 1e-9) ++num_off;
    }
    EXPECT_GT(num_new, 500);
    // The creatures' 2000 tets cut off so much that angles allow only a part of the way in many places.
    const bool is_creature = kind == ShapeKind::dinosaur || kind == ShapeKind::figure;
    EXPECT_LT(num_off, (is_creature ? 0.5 : 0.01) * num_new);
  }
}

TEST(MakeShapeMesh, APostIsABoxOfItsSlenderness) {
  const Shape post = {ShapeKind::box, 0.1, 4.0};  // 25 mm × 25 mm × 100 mm
  for (const int target : {300, 1200, 5000}) {
    const mesh::TetMesh mesh = make_shape_mesh(post, target);
    EXPECT_NEAR(mesh.num_tets(), target, 0.15 * target);
    EXPECT_NEAR((mesh.vertices.rowwise().maxCoeff() - Vec3(0.0125, 0.0125, 0.1)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((mesh.vertices.rowwise().minCoeff() - Vec3(-0.0125, -0.0125, 0.0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR(mesh::compute_volumes(mesh.vertices, mesh.tets).sum(), 6.25e-5, 1e-17);
  }
  const mesh::TriangleMesh skin = make_shape_skin(post, 1000);
  EXPECT_GE(skin.num_triangles(), 1000);
  EXPECT_NEAR((skin.vertices.rowwise().maxCoeff() - Vec3(0.0125, 0.0125, 0.1)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(make_implicit_shape(post).value(Vec3(0.0, 0.02, 0.05)), 0.0075, 1e-15);
}

TEST(MakeShapeMesh, BoxHasItsExactVolumeAndArea) {
  const mesh::TetMesh mesh = make_shape_mesh({ShapeKind::box, 0.2}, 3000);
  EXPECT_NEAR(mesh::compute_volumes(mesh.vertices, mesh.tets).sum(), 0.008, 1e-15);
  EXPECT_NEAR(test::compute_area(mesh.vertices, mesh::make_topology(mesh).boundary), 6 * 0.04, 1e-14);
}

TEST(MakeShapeMesh, CylinderHoldsThePrismOverTheRegularPolygonOfItsRim) {
  for (const int target : {2000, 16000}) {
    const mesh::TetMesh mesh = make_shape_mesh({ShapeKind::cylinder, 1.0}, target);
    int sides = 0;  // vertices on the rim of the bottom
    for (int v = 0; v < mesh.num_vertices(); ++v)
      if (mesh.vertices(2, v) == 0.0 && std::abs(mesh.vertices.col(v).head<2>().norm() - 0.25) < 1e-12)
        ++sides;
    EXPECT_GE(sides, target == 2000 ? 12 : 20);
    const double area = 0.5 * sides * 0.0625 * std::sin(2.0 * kPi / sides);
    EXPECT_NEAR(mesh::compute_volumes(mesh.vertices, mesh.tets).sum(), area, 1e-14);
  }
}

TEST(MakeShapeMesh, CylinderBoundaryLiesOnTheTrueSurface) {
  const Shape shape = {ShapeKind::cylinder, 0.1};
  const ImplicitSurface surface = make_implicit_shape(shape);
  const mesh::TetMesh mesh = make_shape_mesh(shape, 5000);
  const mesh::Topology topology = mesh::make_topology(mesh);
  for (Eigen::Index i = 0; i < topology.boundary.size(); ++i)
    ASSERT_NEAR(surface.value(mesh.vertices.col(topology.boundary.data()[i])), 0.0, 1e-16);
}

TEST(MakeShapeMesh, EveryShapeStandsOnTheGroundCentredAndHasItsSize) {
  for (const ShapeKind kind : kAllShapes) {
    SCOPED_TRACE(static_cast<int>(kind));
    const mesh::TetMesh mesh = make_shape_mesh({kind, 0.3}, 40000);
    const Vec3 lower = mesh.vertices.rowwise().minCoeff();
    const Vec3 upper = mesh.vertices.rowwise().maxCoeff();
    const double h =
        std::cbrt(12.0 * mesh::compute_volumes(mesh.vertices, mesh.tets).sum() / mesh.num_tets());
    EXPECT_NEAR(lower(2), 0.0, 0.1 * h);  // a curved bottom is cut flat by its facets
    EXPECT_NEAR(lower(1) + upper(1), 0.0, 1e-9);
    const Vec3 extent = upper - lower;
    // The creatures' outermost tips are rounded off by the lattice.
    EXPECT_NEAR(kind == ShapeKind::dinosaur ? extent(0) : extent(2), 0.3, 0.8 * h);
  }
}

TEST(MakeShapeMesh, GivesTheSameBitsTwice) {
  for (const ShapeKind kind : kAllShapes)
    EXPECT_EQ(test::hash_mesh(make_shape_mesh({kind, 0.1}, 3000)),
              test::hash_mesh(make_shape_mesh({kind, 0.1}, 3000)));
}

TEST(MakeShapeMesh, RefusesWhatItCannotMake) {
  EXPECT_THROW(make_shape_mesh({ShapeKind::box, 0.0}, 1000), InputError);
  EXPECT_THROW(make_shape_mesh({ShapeKind::sphere, std::nan("")}, 1000), InputError);
  EXPECT_THROW(make_shape_mesh({ShapeKind::sphere, 0.1}, 50), InputError);
  EXPECT_THROW(make_shape_mesh({ShapeKind::sphere, 0.1}, 2000000000), InputError);
}

TEST(MakeShapeSkin, HasTheTrianglesAskedForAndIsOneClosedManifold) {
  for (const ShapeKind kind : kAllShapes) {
    SCOPED_TRACE(static_cast<int>(kind));
    const mesh::TriangleMesh skin = make_shape_skin({kind, 0.1}, 20000);
    EXPECT_GE(skin.num_triangles(), 20000);
    EXPECT_LE(skin.num_triangles(), 40000);
    const test::SurfaceFacts facts = test::compute_surface_facts(skin.vertices, skin.triangles);
    EXPECT_TRUE(facts.is_manifold);
    EXPECT_EQ(facts.euler_characteristic, 2);
    EXPECT_GT(facts.smallest_angle, 8.0);
    EXPECT_GT(test::compute_enclosed_volume(skin.vertices, skin.triangles), 0.0);
  }
}

TEST(MakeShapeSkin, CreaturesAreMirroredInY) {
  for (const ShapeKind kind : {ShapeKind::dinosaur, ShapeKind::figure}) {
    const ImplicitSurface surface = make_implicit_shape({kind, 0.1});
    const mesh::TriangleMesh skin = make_shape_skin({kind, 0.1}, 5000);
    for (int v = 0; v < skin.num_vertices(); ++v) {
      const Vec3 mirrored = skin.vertices.col(v).cwiseProduct(Vec3(1, -1, 1));
      ASSERT_NEAR(surface.value(mirrored), surface.value(skin.vertices.col(v)), 1e-16);
    }
  }
}

TEST(FlattenTet, LowersOneTetAndKeepsTheBody) {
  for (const ShapeKind kind : kAllShapes)
    for (const double share : {0.5, 1e-3, 1e-7}) {
      SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(kind) << ", share " << share);
      const mesh::TetMesh sound = make_shape_mesh({kind, 0.1}, 2000);
      mesh::TetMesh mesh = sound;
      mesh::flatten_tet(mesh, share);
      const Field before = mesh::compute_volumes(sound.vertices, sound.tets);
      const Field after = mesh::compute_volumes(mesh.vertices, mesh.tets);
      const Field ratio = after.cwiseQuotient(before);
      EXPECT_NEAR(ratio.minCoeff(), share, 1e-9);            // on the same base
      EXPECT_LE((ratio.array() < share + 1e-9).count(), 4);  // with what shares its plane
      EXPECT_NEAR(after.sum(), before.sum(), 1e-12 * before.sum());
      EXPECT_EQ(((mesh.vertices - sound.vertices).colwise().norm().array() > 0.0).count(), 1);
      EXPECT_EQ(mesh::make_topology(mesh).boundary, mesh::make_topology(sound).boundary);
    }
}

TEST(FlattenTet, RefusesABodyWithoutVerticesWithin) {
  mesh::TetMesh one;
  one.vertices = Points::Identity(3, 4);
  one.tets = Eigen::Vector4i(3, 0, 1, 2);
  EXPECT_THROW(mesh::flatten_tet(one, 0.5), InputError);
}

}  // namespace
}  // namespace argil::shapes
