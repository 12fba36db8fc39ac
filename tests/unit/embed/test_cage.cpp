// Cages: every vertex inside whatever the surface lacks, wanted count, proven angles, smooth boundary, same
// bits.
#include "embed/cage.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "base/error.h"
#include "mesh_files/readers.h"
#include "shapes/shapes.h"
#include "support/shared_data.h"
#include "unit/embed/cage_checks.h"

namespace argil::embed {
namespace {

TEST(MakeCage, EnclosesAStandingFigure) {
  ARGIL_NEED_SHARED_DATA("surface/Animated_Human.obj");
  const mesh::TriangleMesh surface =
      mesh_files::read_triangle_mesh(test::shared_data("surface/Animated_Human.obj"));
  ASSERT_EQ(surface.num_triangles(), 1578);
  for (const int target : {2000, 10000}) expect_good_cage(surface, target, "Animated_Human.obj");
}

TEST(MakeCage, EnclosesADinosaurWithHolesAndDegenerateFaces) {
  ARGIL_NEED_SHARED_DATA("surface/Stegosaurus.obj");
  const mesh::TriangleMesh surface =
      mesh_files::read_triangle_mesh(test::shared_data("surface/Stegosaurus.obj"));
  ASSERT_EQ(surface.num_vertices(), 1141);
  for (const int target : {2000, 10000}) expect_good_cage(surface, target, "Stegosaurus.obj");
}

TEST(MakeCage, EnclosesAnOpenSheetALooseVertexAndABodyTurnedInsideOut) {
  mesh::TriangleMesh sheet;
  sheet.vertices.resize(3, 5);
  sheet.vertices << 0, 1, 1, 0, 1.2,  //
      0, 0, 1, 1, 1.2,                //
      0, 0, 0, 0.3, 0.1;
  sheet.triangles.resize(3, 3);
  sheet.triangles << 0, 0, 1,  //
      1, 2, 1,                 //
      2, 3, 2;                 // the last is degenerate, vertex 4 belongs to none
  expect_good_cage(sheet, 2000, "sheet");

  mesh::TriangleMesh reversed = shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.1}, 500);
  reversed.triangles.row(0).swap(reversed.triangles.row(1));
  expect_good_cage(reversed, 2000, "reversed");
  const Cage cage = make_cage(reversed, {2000}, "reversed");  // full, not a shell
  EXPECT_NO_THROW(make_embedding(cage.mesh, Points(Vec3(0, 0, 0.05)), "centre"));
}

TEST(MakeCage, StackedSheetsThatWindFarRoundStayInTheirBox) {
  mesh::TriangleMesh sheets;
  sheets.vertices.resize(3, 30);
  sheets.triangles.resize(3, 10);
  for (int i = 0; i < 10; ++i) {
    sheets.vertices.middleCols(3 * i, 3) << 0, 1, 0,  //
        0, 0, 1,                                      //
        0.01 * i, 0.01 * i, 0.01 * i;
    sheets.triangles.col(i) << 3 * i, 3 * i + 1, 3 * i + 2;
  }
  expect_good_cage(sheets, 2000, "sheets");
}

TEST(MakeCage, ClosesAHoleByWhatTheSurfaceWindsRound) {
  // A bowl of three quarters of a sphere: its cage holds the inside up to about the plane of the mouth.
  mesh::TriangleMesh bowl = shapes::make_shape_skin({shapes::ShapeKind::sphere, 1.0}, 3000);
  int kept = 0;
  for (int t = 0; t < bowl.num_triangles(); ++t)
    if (bowl.vertices(2, bowl.triangles(0, t)) < 0.75) bowl.triangles.col(kept++) = bowl.triangles.col(t);
  bowl.triangles.conservativeResize(3, kept);
  Points inside(3, 3);
  inside << 0, 0.2, 0,  //
      0, 0, -0.2,       //
      0.5, 0.3, 0.65;
  bowl.vertices.conservativeResize(3, bowl.num_vertices());
  mesh::TriangleMesh used = bowl;  // only the vertices below the mouth
  std::vector<int> number(static_cast<std::size_t>(bowl.num_vertices()), -1);
  int num_used = 0;
  for (Eigen::Index i = 0; i < used.triangles.size(); ++i) {
    int& n = number[static_cast<std::size_t>(bowl.triangles.data()[i])];
    if (n < 0) {
      n = num_used++;
      used.vertices.col(n) = bowl.vertices.col(bowl.triangles.data()[i]);
    }
    used.triangles.data()[i] = n;
  }
  used.vertices.conservativeResize(3, num_used);
  const Cage cage = make_cage(used, {4000}, "bowl");
  EXPECT_NO_THROW(make_embedding(cage.mesh, inside, "inside"));
  EXPECT_LT(cage.mesh.vertices.row(2).maxCoeff(), 0.95);  // the missing cap stays out
}

TEST(MakeCage, HugsASphereSmoothlyWhereAVoxelStaircaseTurnsByNinetyDegrees) {
  const mesh::TriangleMesh skin = shapes::make_shape_skin({shapes::ShapeKind::sphere, 1.0}, 20000);
  const Cage cage = make_cage(skin, {10000}, "sphere");
  const test::SurfaceFacts facts =
      test::compute_surface_facts(cage.mesh.vertices, mesh::make_topology(cage.mesh).boundary);
  // As for the stuffing: facets inscribed in a sphere of radius R tilt by less than asin(h/R) against its
  // normal.
  const double bound = 2.0 * std::asin(cage.report.cell_size / 0.5) * 180.0 / std::acos(-1.0);
  EXPECT_LT(facts.sharpest_edge, bound);
  EXPECT_LT(facts.sharpest_edge, 25.0);
  EXPECT_EQ(facts.euler_characteristic, 2);
  // No vertex farther out than the offset.
  double farthest = 0.0;
  for (int v = 0; v < cage.mesh.num_vertices(); ++v)
    farthest = std::max(farthest, (cage.mesh.vertices.col(v) - Vec3(0, 0, 0.5)).norm() - 0.5);
  EXPECT_NEAR(farthest, cage.report.max_distance, 0.02 * cage.report.cell_size);
  EXPECT_LT(cage.report.max_distance, 0.2 * cage.report.cell_size);
}

TEST(MakeCage, KeepsTheCreaturesInOnePiece) {
  for (const shapes::ShapeKind kind : {shapes::ShapeKind::dinosaur, shapes::ShapeKind::figure}) {
    const mesh::TriangleMesh skin = shapes::make_shape_skin({kind, 0.2}, 5000);
    const Cage cage = make_cage(skin, {2000}, "creature");
    EXPECT_EQ(test::count_components(cage.mesh), 1);
  }
}

TEST(MakeCage, GivesTheSameBitsTwice) {
  const mesh::TriangleMesh skin = shapes::make_shape_skin({shapes::ShapeKind::figure, 0.2}, 3000);
  EXPECT_EQ(test::hash_mesh(make_cage(skin, {2000}, "a").mesh),
            test::hash_mesh(make_cage(skin, {2000}, "b").mesh));
}

TEST(MakeCage, RefusesSurfacesWithoutExtentAndCountsOutOfRange) {
  mesh::TriangleMesh point;
  point.vertices = Points::Zero(3, 3);
  point.triangles = Triangles(3, 1);
  point.triangles << 0, 1, 2;
  EXPECT_THROW(make_cage(point, {2000}, "point"), InputError);
  EXPECT_THROW(make_cage({}, {2000}, "empty"), InputError);
  mesh::TriangleMesh skin = shapes::make_shape_skin({shapes::ShapeKind::sphere, 0.1}, 500);
  EXPECT_THROW(make_cage(skin, {50}, "few"), InputError);
  skin.vertices(0, 3) = std::numeric_limits<double>::infinity();
  try {
    make_cage(skin, {2000}, "inf.obj");
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "inf.obj: vertex 3 (counted from 0): a coordinate is not a finite number; repair the surface file");
  }
}

}  // namespace
}  // namespace argil::embed
