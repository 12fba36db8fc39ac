// Isosurface stuffing: volume of a sphere in closed form, topology from Euler's formula, and the bounds that
// Labelle & Shewchuk (2007) prove for a uniform lattice: dihedral angles between 10.7843 and 164.7405
// degrees.
#include "shapes/implicit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "support/mesh_measures.h"

namespace argil::shapes {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSmallestAngle = 10.78;  // the paper's bounds, rounded outward
constexpr double kLargestAngle = 164.75;

ImplicitSurface make_ball(const Vec3& centre, double radius) {
  ImplicitSurface surface;
  surface.value = [=](const Vec3& x) { return (x - centre).norm() - radius; };
  surface.lower = centre - Vec3::Constant(radius);
  surface.upper = centre + Vec3::Constant(radius);
  return surface;
}

ImplicitSurface make_torus(double ring, double tube) {
  ImplicitSurface surface;
  surface.value = [=](const Vec3& x) { return std::hypot(std::hypot(x(0), x(1)) - ring, x(2)) - tube; };
  surface.lower = Vec3(-ring - tube, -ring - tube, -tube);
  surface.upper = -surface.lower;
  return surface;
}

// Balls of a seeded choice, many of them thinner than the lattice, that overlap, touch and nearly touch.
ImplicitSurface make_crowd(std::uint64_t seed) {
  Rng rng(seed, "crowd");
  std::vector<Vec4> balls(40);
  for (Vec4& ball : balls)
    ball = Vec4(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.03, 0.3));
  ImplicitSurface surface;
  surface.value = [balls](const Vec3& x) {
    double value = 1e9;
    for (const Vec4& ball : balls) value = std::min(value, (x - ball.head<3>()).norm() - ball(3));
    return value;
  };
  surface.lower = Vec3::Constant(-1.3);
  surface.upper = Vec3::Constant(1.3);
  return surface;
}

TEST(StuffIsosurface, SphereVolumeConvergesWithOrderTwo) {
  std::vector<double> sizes;
  std::vector<double> errors;
  for (const double h : {0.2, 0.1, 0.05, 0.025}) {
    const mesh::TetMesh mesh = stuff_isosurface(make_ball({0.013, -0.027, 0.041}, 0.5), h);
    sizes.push_back(h);
    errors.push_back(kPi / 6.0 - mesh::compute_volumes(mesh.vertices, mesh.tets).sum());
    if (errors.size() > 1) {
      EXPECT_LT(errors.back(), errors[errors.size() - 2]);
    }
  }
  const double order = test::fit_order(sizes, errors);  // flat facets inscribed in a sphere lose O(h²)
  EXPECT_GT(order, 1.85);
  EXPECT_LT(order, 2.3);
}

TEST(StuffIsosurface, EveryTetHasPositiveVolumeAndNoCrackIsLeft) {
  const mesh::TetMesh mesh = stuff_isosurface(make_torus(0.5, 0.2), 0.06);
  const Field volumes = mesh::compute_volumes(mesh.vertices, mesh.tets);
  EXPECT_GT(volumes.minCoeff(), 0.0);
  // A crack or an overlap would show as a difference between what the boundary encloses and what the tets
  // fill.
  const mesh::Topology topology = mesh::make_topology(mesh);
  EXPECT_NEAR(test::compute_enclosed_volume(mesh.vertices, topology.boundary), volumes.sum(), 1e-13);
}

TEST(StuffIsosurface, BoundaryHasTheTopologyOfTheSurface) {
  const auto facts = [](const ImplicitSurface& surface, double h) {
    const mesh::TetMesh mesh = stuff_isosurface(surface, h);
    return test::compute_surface_facts(mesh.vertices, mesh::make_topology(mesh).boundary);
  };
  const test::SurfaceFacts ball = facts(make_ball(Vec3::Zero(), 0.5), 0.1);
  EXPECT_TRUE(ball.is_manifold);
  EXPECT_EQ(ball.euler_characteristic, 2);
  const test::SurfaceFacts torus = facts(make_torus(0.5, 0.2), 0.1);
  EXPECT_TRUE(torus.is_manifold);
  EXPECT_EQ(torus.euler_characteristic, 0);
}

TEST(StuffIsosurface, DihedralAnglesKeepThePapersBounds) {
  // Irrational ratios of radius and lattice put the cuts anywhere on the edges.
  for (int i = 0; i < 12; ++i) {
    const double h = 0.31 / (1.0 + 0.37 * i);
    const test::AngleRange range =
        test::compute_dihedral_range(stuff_isosurface(make_ball({0.1, 0.2, 0.3}, 0.5), h));
    EXPECT_GT(range.smallest, kSmallestAngle) << h;
    EXPECT_LT(range.largest, kLargestAngle) << h;
  }
}

TEST(StuffIsosurface, SurfacesFinerThanTheLatticeStayManifoldAndWellShaped) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const mesh::TetMesh mesh = stuff_isosurface(make_crowd(seed), 0.11);
    const test::SurfaceFacts facts =
        test::compute_surface_facts(mesh.vertices, mesh::make_topology(mesh).boundary);
    EXPECT_TRUE(facts.is_manifold) << seed;
    EXPECT_GT(mesh::compute_volumes(mesh.vertices, mesh.tets).minCoeff(), 0.0) << seed;
    // The paper's proof is for surfaces that the lattice resolves; here the worst of 150 seeds was 10.3
    // degrees.
    const test::AngleRange range = test::compute_dihedral_range(mesh);
    EXPECT_GT(range.smallest, 10.0) << seed;
    EXPECT_LT(range.largest, 165.0) << seed;
  }
}

TEST(StuffIsosurface, BoundaryOfASphereBendsGentlyWhereAVoxelStaircaseTurnsByNinetyDegrees) {
  const double radius = 0.5;
  const double h = 0.05;
  const mesh::TetMesh mesh = stuff_isosurface(make_ball({0.01, 0.02, 0.03}, radius), h);
  const test::SurfaceFacts facts =
      test::compute_surface_facts(mesh.vertices, mesh::make_topology(mesh).boundary);
  // A facet inscribed in a sphere whose circumradius is below h is tilted by less than asin(h/R) against the
  // sphere's normal at any of its corners; two facets that share an edge by less than twice that.
  EXPECT_LT(facts.sharpest_edge, 2.0 * std::asin(h / radius) * 180.0 / kPi);
}

TEST(StuffIsosurface, GivesTheSameBitsTwice) {
  EXPECT_EQ(test::hash_mesh(stuff_isosurface(make_crowd(3), 0.1)),
            test::hash_mesh(stuff_isosurface(make_crowd(3), 0.1)));
}

TEST(StuffIsosurface, BoundaryVerticesLieOnTheSurface) {
  const ImplicitSurface surface = make_torus(0.5, 0.2);
  const double h = 0.1;
  const mesh::TetMesh mesh = stuff_isosurface(surface, h);
  const mesh::Topology topology = mesh::make_topology(mesh);
  for (Eigen::Index i = 0; i < topology.boundary.size(); ++i)
    ASSERT_NEAR(surface.value(mesh.vertices.col(topology.boundary.data()[i])), 0.0, 1e-9 * h);
}

TEST(ExtractIsosurface, SphereAreaConvergesWithOrderTwo) {
  std::vector<double> sizes;
  std::vector<double> errors;
  for (const double h : {0.2, 0.1, 0.05, 0.025}) {
    const mesh::TriangleMesh skin = extract_isosurface(make_ball({0.013, -0.027, 0.041}, 0.5), h);
    sizes.push_back(h);
    errors.push_back(kPi - test::compute_area(skin.vertices, skin.triangles));
  }
  const double order = test::fit_order(sizes, errors);
  EXPECT_GT(order, 1.85);
  EXPECT_LT(order, 2.3);
}

TEST(ExtractIsosurface, SkinIsClosedManifoldOnTheSurfaceAndFreeOfSlivers) {
  const ImplicitSurface surface = make_torus(0.5, 0.2);
  const mesh::TriangleMesh skin = extract_isosurface(surface, 0.06);
  const test::SurfaceFacts facts = test::compute_surface_facts(skin.vertices, skin.triangles);
  EXPECT_TRUE(facts.is_manifold);
  EXPECT_EQ(facts.euler_characteristic, 0);
  // The lattice alone bounds a triangle's angles by about 16 degrees; relaxing may only improve the worst
  // ones.
  EXPECT_GT(facts.smallest_angle, 16.0);
  for (int v = 0; v < skin.num_vertices(); ++v) ASSERT_NEAR(surface.value(skin.vertices.col(v)), 0.0, 1e-9);
  // Pappus: 2π²·ring·tube², normals outward.
  EXPECT_NEAR(test::compute_enclosed_volume(skin.vertices, skin.triangles), 2.0 * kPi * kPi * 0.5 * 0.04,
              0.02 * 2.0 * kPi * kPi * 0.5 * 0.04);
}

TEST(StuffIsosurfaceDeathTest, ABoxThatCutsTheSurfaceIsOurMistake) {
  ImplicitSurface surface = make_ball(Vec3::Zero(), 0.5);
  surface.lower = Vec3::Constant(-0.2);
  surface.upper = Vec3::Constant(0.2);
  EXPECT_DEATH(stuff_isosurface(surface, 0.05), "box does not contain the surface");
}

}  // namespace
}  // namespace argil::shapes
