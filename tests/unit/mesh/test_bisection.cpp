// Halving of tets: parts of a cubic lattice are of the known three shapes, nothing is lost or left open, and
// sizes are those that are wanted.
#include "mesh/bisection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/quality.h"
#include "mesh/topology.h"
#include "shapes/hexahedra.h"
#include "shapes/shapes.h"

namespace argil::mesh {
namespace {

constexpr int kNoLimit = 1'000'000;

TetMesh make_cubes(double edge = 1.0) {
  return shapes::split_hexahedra(shapes::make_box_hexahedra(Vec3(2.0, 2.0, 2.0) * edge, {2, 2, 2}));
}

/// Of a mesh of edge lengths about 1: small at a corner of its top.
double wanted_at(const Vec3& x) {
  return 0.03 + 0.3 * (x - Vec3(1.0, 1.0, 2.0)).norm();
}

double compute_area(const TetMesh& mesh) {
  const Triangles boundary = make_topology(mesh).boundary;
  double area = 0.0;
  for (const auto& t : boundary.colwise())
    area += 0.5 * (mesh.vertices.col(t(1)) - mesh.vertices.col(t(0)))
                      .cross(mesh.vertices.col(t(2)) - mesh.vertices.col(t(0)))
                      .norm();
  return area;
}

TEST(Bisection, OfCubesGivesTheThreeShapesOfTheirLattice) {
  const BisectedMesh fine = bisect(make_cubes(), wanted_at, kNoLimit);
  ASSERT_GT(fine.mesh.num_tets(), 1000);
  const QualityReport quality = compute_quality(fine.mesh);
  EXPECT_GE(quality.min_dihedral_degrees, 45.0 - 1e-9);
  EXPECT_LE(quality.max_dihedral_degrees, 120.0 + 1e-9);
}

TEST(Bisection, FillsTheSameBodyWithoutGaps) {
  for (const shapes::ShapeKind kind :
       {shapes::ShapeKind::sphere, shapes::ShapeKind::cylinder, shapes::ShapeKind::figure}) {
    const TetMesh coarse = shapes::make_shape_mesh({kind, 2.0}, 1500);
    const BisectedMesh fine = bisect(
        coarse, [](const Vec3& x) { return 0.01 + 0.2 * (x - Vec3(0.0, 0.0, 1.9)).norm(); }, kNoLimit);
    ASSERT_GT(fine.mesh.num_tets(), coarse.num_tets() + 100);
    const QualityReport quality = compute_quality(fine.mesh);
    EXPECT_TRUE(quality.overfull_faces.empty());
    EXPECT_TRUE(quality.orphan_vertices.empty());
    EXPECT_TRUE(quality.inverted.empty());
    EXPECT_EQ(quality.num_non_manifold_edges, 0);
    EXPECT_EQ(quality.num_components, 1);
    // An open face or a vertex in the middle of a neighbour's edge would be boundary, too.
    EXPECT_NEAR(compute_area(fine.mesh), compute_area(coarse), 1e-12 * compute_area(coarse));
    EXPECT_NEAR(quality.volume, compute_quality(coarse).volume, 1e-12 * quality.volume);
  }
}

TEST(Bisection, MakesEveryCellAsSmallAsWantedAndFewSmaller) {
  const TetMesh coarse = make_cubes();
  const BisectedMesh fine = bisect(coarse, wanted_at, kNoLimit);
  const Field volume = compute_volumes(fine.mesh.vertices, fine.mesh.tets);
  double wanted_number = 0.0;  // Σ over tets of how many of the wanted size would fill it
  for (int t = 0; t < fine.mesh.num_tets(); ++t) {
    Vec3 centre = Vec3::Zero();
    for (const int v : fine.mesh.tets.col(t)) centre += 0.25 * fine.mesh.vertices.col(v);
    const double size = std::cbrt(12.0 * volume(t));
    EXPECT_LE(size, wanted_at(centre));
    wanted_number += std::pow(size / wanted_at(centre), 3);
  }
  // Tets of a half to the whole wanted volume, and those that had to go along.
  EXPECT_GT(wanted_number, 0.5 * fine.mesh.num_tets());
}

TEST(Bisection, GivesFieldsAndVolumeToTheParts) {
  TetMesh coarse = make_cubes();
  Field& E = coarse.cell_fields["E"];
  E = Field::LinSpaced(coarse.num_tets(), 1.0, 2.0);
  const Field volume = compute_volumes(coarse.vertices, coarse.tets);
  const BisectedMesh fine = bisect(coarse, wanted_at, kNoLimit);
  ASSERT_EQ(fine.parent.size(), static_cast<std::size_t>(fine.mesh.num_tets()));
  const Field fine_volume = compute_volumes(fine.mesh.vertices, fine.mesh.tets);
  Field sum = Field::Zero(coarse.num_tets());
  for (int t = 0; t < fine.mesh.num_tets(); ++t) {
    const int parent = fine.parent[static_cast<std::size_t>(t)];
    sum(parent) += fine_volume(t);
    EXPECT_EQ(fine.mesh.cell_fields.at("E")(t), E(parent));
  }
  EXPECT_LT((sum - volume).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Bisection, KeepsVerticesAndSaysWhereTheNewOnesAre) {
  const TetMesh coarse = make_cubes();
  const BisectedMesh fine = bisect(coarse, wanted_at, kNoLimit);
  const int num_old = coarse.num_vertices();
  ASSERT_EQ(fine.halved_edge.size(), static_cast<std::size_t>(fine.mesh.num_vertices() - num_old));
  EXPECT_EQ(fine.mesh.vertices.leftCols(num_old), coarse.vertices);
  for (std::size_t i = 0; i < fine.halved_edge.size(); ++i) {
    const auto [a, b] = fine.halved_edge[i];
    const int v = num_old + static_cast<int>(i);
    EXPECT_LT(std::max(a, b), v);
    EXPECT_EQ(fine.mesh.vertices.col(v), 0.5 * (fine.mesh.vertices.col(a) + fine.mesh.vertices.col(b)));
  }
}

TEST(Bisection, IsTheSameInOtherUnits) {
  const BisectedMesh metres = bisect(make_cubes(), wanted_at, kNoLimit);
  const BisectedMesh small = bisect(
      make_cubes(1.0 / 1024.0), [](const Vec3& x) { return wanted_at(1024.0 * x) / 1024.0; }, kNoLimit);
  EXPECT_EQ(metres.mesh.tets, small.mesh.tets);
}

TEST(Bisection, LeavesAloneWhatIsSmallEnough) {
  const TetMesh coarse = make_cubes();
  const BisectedMesh same = bisect(
      coarse, [](const Vec3&) { return 1.01; }, kNoLimit);
  EXPECT_EQ(same.mesh.tets, coarse.tets);
  EXPECT_TRUE(same.halved_edge.empty());
}

TEST(Bisection, StopsSoonAfterTheLargestNumber) {
  const BisectedMesh fine = bisect(
      make_cubes(), [](const Vec3&) { return 0.01; }, 5000);
  EXPECT_GT(fine.mesh.num_tets(), 5000);
  EXPECT_LT(fine.mesh.num_tets(), 6000);
  EXPECT_TRUE(compute_quality(fine.mesh).overfull_faces.empty());
}

}  // namespace
}  // namespace argil::mesh
