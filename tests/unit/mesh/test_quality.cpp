// Quality of tet meshes and surfaces. Angles are those of solids known in closed form: the regular
// tetrahedron arccos(1/3), the corner of a cube 90° and arccos(1/√3), a low pyramid over an equilateral
// triangle atan(h/r).
#include "mesh/quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/rng.h"
#include "support/block_mesh.h"
#include "support/mesh_measures.h"
#include "support/surface_report.h"
#include "support/temp_folder.h"
#include "support/two_tets.h"

namespace argil::mesh {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kAngleRounding = 1e-12;  // degrees; some 10 roundings of numbers near 180

TetMesh make_tet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  TetMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << a, b, c, d;
  mesh.tets = Eigen::Vector4i(0, 1, 2, 3);
  return mesh;
}

TetMesh make_corner_tet(double size = 1.0, const Vec3& at = Vec3::Zero()) {
  return make_tet(at, at + Vec3(size, 0, 0), at + Vec3(0, size, 0), at + Vec3(0, 0, size));
}

// Both meshes as one; vertex `from[i]` of the second is vertex `to[i]` of the first.
TetMesh join(const TetMesh& a, const TetMesh& b, const std::vector<int>& from = {},
             const std::vector<int>& to = {}) {
  TetMesh mesh = a;
  std::vector<int> number(static_cast<std::size_t>(b.num_vertices()), -1);
  for (std::size_t i = 0; i < from.size(); ++i) number[static_cast<std::size_t>(from[i])] = to[i];
  for (int v = 0; v < b.num_vertices(); ++v) {
    int& n = number[static_cast<std::size_t>(v)];
    if (n >= 0) continue;
    n = mesh.num_vertices();
    mesh.vertices.conservativeResize(Eigen::NoChange, n + 1);
    mesh.vertices.col(n) = b.vertices.col(v);
  }
  mesh.tets.conservativeResize(Eigen::NoChange, a.num_tets() + b.num_tets());
  for (int t = 0; t < b.num_tets(); ++t)
    for (int c = 0; c < 4; ++c)
      mesh.tets(c, a.num_tets() + t) = number[static_cast<std::size_t>(b.tets(c, t))];
  return mesh;
}

TEST(Quality, RegularTetHasTheAngleArccosOneThird) {
  const QualityReport report =
      compute_quality(make_tet(Vec3(1, 1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1), Vec3(-1, -1, 1)));
  EXPECT_NEAR(report.min_dihedral_degrees, std::acos(1.0 / 3.0) * kDegrees, kAngleRounding);
  EXPECT_NEAR(report.max_dihedral_degrees, std::acos(1.0 / 3.0) * kDegrees, kAngleRounding);
  EXPECT_NEAR(report.volume, 8.0 / 3.0, 1e-15);
}

TEST(Quality, CornerOfACubeHasRightAnglesAndArccosOneBySqrtThree) {
  const QualityReport report = compute_quality(make_corner_tet());
  EXPECT_NEAR(report.min_dihedral_degrees, std::acos(1.0 / std::sqrt(3.0)) * kDegrees, kAngleRounding);
  EXPECT_NEAR(report.max_dihedral_degrees, 90.0, kAngleRounding);
}

TEST(Quality, ALowPyramidHasFlatAndObtuseAngles) {
  constexpr double h = 0.05;
  const double inradius = 0.5 / std::sqrt(3.0);
  const QualityReport report = compute_quality(
      make_tet(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, std::sqrt(0.75), 0), Vec3(0.5, inradius, h)));
  EXPECT_NEAR(report.min_dihedral_degrees, std::atan(h / inradius) * kDegrees, kAngleRounding);
  // Between two side faces with outward normals (r sinα…): cos = −n₁·n₂ with n = (h e, r)/√(h²+r²), e at
  // 120°.
  const double cosine = (0.5 * h * h - inradius * inradius) / (h * h + inradius * inradius);
  EXPECT_NEAR(report.max_dihedral_degrees, std::acos(cosine) * kDegrees, 1e-10);
}

// Seeded: angles by the normals of faces against angles in the plane across each edge.
TEST(Quality, DihedralAnglesAgreeWithASecondFormula) {
  Rng rng(11, "dihedral");
  for (int trial = 0; trial < 200; ++trial) {
    TetMesh mesh = make_corner_tet();
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) mesh.vertices.data()[i] = rng.uniform(-1.0, 1.0);
    const test::AngleRange expected = test::compute_dihedral_range(mesh);
    const QualityReport report = compute_quality(mesh);
    // Rounding, enlarged by the thinness of the worst of the random tets.
    EXPECT_NEAR(report.min_dihedral_degrees, expected.smallest, 1e-9);
    EXPECT_NEAR(report.max_dihedral_degrees, expected.largest, 1e-9);
  }
}

TEST(Quality, ABlockIsCleanAndItsVolumeIsThatOfTheBox) {
  const TetMesh mesh = test::make_block(3, 2, 4, Vec3(0.3, 0.2, 0.4));
  const QualityReport report = compute_quality(mesh);
  EXPECT_EQ(report.num_tets, 6 * 24);
  EXPECT_EQ(report.num_vertices, 4 * 3 * 5);
  EXPECT_NEAR(report.volume, 0.024, 1e-16);
  EXPECT_EQ(report.num_components, 1);
  EXPECT_NEAR(report.min_dihedral_degrees, 45.0, 1e-10);  // Kuhn's tets of a cube
  EXPECT_NEAR(report.max_dihedral_degrees, 90.0, 1e-10);
  EXPECT_EQ(require_usable(report, "block.msh"), "");
}

TEST(Quality, InvertedTetsAreNamedAndRefused) {
  TetMesh mesh = test::make_block(3, 2, 2, Vec3(1, 1, 1));
  for (int t = 5; t < 20; ++t) std::swap(mesh.tets(0, t), mesh.tets(1, t));
  const QualityReport report = compute_quality(mesh);
  ASSERT_EQ(report.inverted.size(), 15U);
  EXPECT_EQ(report.inverted.front(), 5);
  EXPECT_TRUE(report.flat.empty());
  ARGIL_EXPECT_THROW_WITH(
      require_usable(report, "a.msh"), InputError,
      "a.msh: tets: 15 of 72 have negative volume: 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, … (counted "
      "from 0); mesh again");
}

TEST(Quality, AMirroredMeshIsRefusedWithTheWayOut) {
  TetMesh mesh = test::make_block(1, 1, 1, Vec3(1, 1, 1));
  mesh.vertices.row(2) *= -1.0;
  ARGIL_EXPECT_THROW_WITH(require_usable(compute_quality(mesh), "a.msh"), InputError,
                          "the whole mesh is mirrored");
}

TEST(Quality, FlatTetsAreFlatAtAnyPlaceAndSize) {
  for (const double size : {1e-9, 1.0, 1e9}) {
    const TetMesh flat =
        make_tet(Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(0, size, 0), Vec3(size / 3, size / 3, 0));
    EXPECT_EQ(compute_quality(flat).flat, std::vector<int>{0}) << size;
    EXPECT_TRUE(compute_quality(flat).inverted.empty());
    EXPECT_TRUE(compute_quality(make_corner_tet(size)).flat.empty()) << size;
  }
  // So far out that the corners themselves are only known to the size of the tet.
  EXPECT_EQ(compute_quality(make_corner_tet(1e-3, Vec3(1e13, 0, 0))).flat, std::vector<int>{0});
  EXPECT_TRUE(compute_quality(make_corner_tet(1e-3, Vec3(1e3, 0, 0))).flat.empty());
  const TetMesh twice = make_tet(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 1, 0));
  EXPECT_EQ(compute_quality(twice).flat, std::vector<int>{0});
  EXPECT_EQ(compute_quality(twice).min_dihedral_degrees, 0.0);
  ARGIL_EXPECT_THROW_WITH(require_usable(compute_quality(twice), "a.msh"), InputError,
                          "a.msh: tets: 1 of 1 have no volume beyond round-off: 0");
}

// Turned and moved away, four points of a plane are on it only to round-off, and either sign of volume comes
// out.
TEST(Quality, APlaneHitOnlyToRoundOffIsFlatAndNotInverted) {
  Rng rng(12, "plane");
  int num_negative = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Quat turn(Eigen::AngleAxisd(rng.uniform(0.0, 6.0), Vec3(1.0, 2.0, rng.uniform()).normalized()));
    const Vec3 away = 1000.0 * Vec3(1.0, -0.3, rng.uniform());
    TetMesh mesh = make_tet(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.3, 0.3, 0));
    for (int v = 0; v < 4; ++v) mesh.vertices.col(v) = turn * Vec3(mesh.vertices.col(v)) + away;
    const QualityReport report = compute_quality(mesh);
    EXPECT_EQ(report.flat, std::vector<int>{0}) << "trial " << trial << " volume " << report.volume;
    EXPECT_TRUE(report.inverted.empty());
    num_negative += report.volume < 0.0 ? 1 : 0;
  }
  EXPECT_GT(num_negative, 0);  // else the trials ask nothing
  EXPECT_LT(num_negative, kTrials);
}

TEST(Quality, AThinTetIsNotFlat) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    // Height over width 1e-9, far above the 1e-16 of rounding.
    const TetMesh thin = make_tet(Vec3(0, 0, 0), Vec3(size, 0, 0), Vec3(0, size, 0), Vec3(0, 0, 1e-9 * size));
    EXPECT_TRUE(compute_quality(thin).flat.empty()) << size;
    EXPECT_TRUE(compute_quality(thin).inverted.empty()) << size;
  }
}

TEST(Quality, OrphanVerticesAreNamedAndRefused) {
  TetMesh mesh = make_corner_tet();
  mesh.vertices.conservativeResize(Eigen::NoChange, 6);
  mesh.vertices.rightCols(2).setZero();
  EXPECT_EQ(compute_quality(mesh).orphan_vertices, (std::vector<int>{4, 5}));
  ARGIL_EXPECT_THROW_WITH(require_usable(compute_quality(mesh), "a.msh"), InputError,
                          "a.msh: vertices: 2 of 6 belong to no tet: 4, 5");
}

TEST(Quality, AFaceOfThreeTetsOrOfTwoOnOneSideIsRefused) {
  const TetMesh two = test::make_two_tets();  // meet in the face 1 2 3
  EXPECT_TRUE(compute_quality(two).overfull_faces.empty());
  const TetMesh third = make_tet(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(2, 2, 2));
  EXPECT_EQ(compute_quality(join(two, third, {0, 1, 2}, {1, 2, 3})).overfull_faces,
            (std::vector<int>{0, 1, 2}));
  const TetMesh tet = make_corner_tet();
  const TetMesh over = make_tet(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 2));
  const QualityReport same_side = compute_quality(join(tet, over, {0, 1, 2}, {0, 1, 2}));
  EXPECT_EQ(same_side.overfull_faces, (std::vector<int>{0, 1}));
  ARGIL_EXPECT_THROW_WITH(require_usable(same_side, "a.msh"), InputError, "or two from the same side: 0, 1");
}

TEST(Quality, PartsThatOnlyTouchAreCountedAndWarnedOf) {
  const TetMesh tet = make_corner_tet();
  const TetMesh mirrored = make_tet(Vec3(0, 0, 0), Vec3(0, -1, 0), Vec3(-1, 0, 0), Vec3(0, 0, -1));
  const QualityReport apart = compute_quality(join(tet, make_corner_tet(1.0, Vec3(5, 5, 5))));
  EXPECT_EQ(apart.num_components, 2);
  EXPECT_EQ(require_usable(apart, "a.msh"), "");

  const QualityReport by_vertex = compute_quality(join(tet, make_corner_tet(1.0, Vec3(1, 0, 0)), {0}, {1}));
  EXPECT_EQ(by_vertex.num_components, 2);
  EXPECT_EQ(by_vertex.non_manifold_vertices, std::vector<int>{1});
  EXPECT_EQ(by_vertex.num_non_manifold_edges, 0);
  EXPECT_NE(require_usable(by_vertex, "a.msh").find("1 vertices and 0 edges where parts only touch"),
            std::string::npos);

  const TetMesh by_z = make_tet(Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1));
  const QualityReport by_edge = compute_quality(join(tet, by_z, {0, 3}, {0, 3}));
  EXPECT_EQ(by_edge.num_components, 2);
  EXPECT_EQ(by_edge.non_manifold_vertices, (std::vector<int>{0, 3}));
  EXPECT_EQ(by_edge.num_non_manifold_edges, 1);
  EXPECT_TRUE(by_edge.inverted.empty());
}

TriangleMesh make_surface(const std::vector<std::array<int, 3>>& triangles) {
  TriangleMesh surface;
  surface.vertices = (Points(3, 5) << 0, 1, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0).finished();
  surface.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    surface.triangles.col(static_cast<Eigen::Index>(t)) = Eigen::Vector3i(triangles[t].data());
  return surface;
}

TEST(SurfaceReport, ATetrahedronIsClosedAndAnOpenOneIsNot) {
  EXPECT_TRUE(
      test::compute_surface_report(make_surface({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})).is_closed());
  const test::SurfaceReport open =
      test::compute_surface_report(make_surface({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}));
  EXPECT_EQ(open.num_boundary_edges, 3);
  EXPECT_FALSE(open.is_closed());
}

TEST(SurfaceReport, ATurnedTriangleAndAThirdOneMakeEdgesNonManifold) {
  const test::SurfaceReport turned =
      test::compute_surface_report(make_surface({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 3, 2}}));
  EXPECT_EQ(turned.num_non_manifold_edges, 3);
  EXPECT_EQ(turned.num_boundary_edges, 0);
  const test::SurfaceReport third =
      test::compute_surface_report(make_surface({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(third.num_non_manifold_edges, 1);
  EXPECT_EQ(third.num_boundary_edges, 4 + 2);
}

TEST(SurfaceReport, TrianglesWithoutAreaAreCounted) {
  const test::SurfaceReport line =
      test::compute_surface_report(make_surface({{0, 1, 4}}));  // three places on the x axis
  EXPECT_EQ(line.num_degenerate, 1);
  EXPECT_EQ(line.num_boundary_edges, 3);
  const test::SurfaceReport point = test::compute_surface_report(make_surface({{0, 1, 1}}));
  EXPECT_EQ(point.num_degenerate, 1);
  EXPECT_EQ(point.num_boundary_edges, 0);
}

// 12 (3V)^⅔ / Σ l²: of the corner of a cube V = 1/6 and Σ l² = 9.
TEST(Quality, ShapeIsOneWhereTheTetIsRegularAndNoneWhereItIsFlat) {
  EXPECT_NEAR(compute_shape({Vec3(1, 1, 1), Vec3(-1, 1, -1), Vec3(1, -1, -1), Vec3(-1, -1, 1)}), 1.0, 1e-14);
  const std::array<Vec3, 4> corner = {Vec3::Zero(), 0.01 * Vec3::UnitX(), 0.01 * Vec3::UnitY(),
                                      0.01 * Vec3::UnitZ()};
  EXPECT_NEAR(compute_shape(corner), 12.0 * std::pow(0.5, 2.0 / 3.0) / 9.0, 1e-14);
  EXPECT_EQ(compute_shape({corner[0], corner[1], corner[2], -corner[3]}), 0.0);
}

}  // namespace
}  // namespace argil::mesh
