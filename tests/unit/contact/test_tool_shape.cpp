// Tool surfaces: closed, of the size that was asked for; open and inverted ones are refused.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.h"
#include "contact/tool_shape.h"

namespace argil::contact {
namespace {

double compute_volume(const mesh::TriangleMesh& m) {
  double six = 0.0;
  for (int t = 0; t < m.num_triangles(); ++t)
    six += Vec3(m.vertices.col(m.triangles(0, t)))
               .dot(Vec3(m.vertices.col(m.triangles(1, t))).cross(Vec3(m.vertices.col(m.triangles(2, t)))));
  return six / 6.0;
}

TEST(ToolShape, SphereLiesOnItsRadiusAndItsVolumeConverges) {
  const double exact = 4.0 / 3.0 * std::numbers::pi * 1e-6;
  double last = 0.0;
  for (int level = 0; level <= 4; ++level) {
    const mesh::TriangleMesh m = make_sphere_tool(0.01, level);
    EXPECT_NO_THROW(require_closed_surface(m, "sphere"));
    EXPECT_EQ(m.num_triangles(), 20 << (2 * level));
    EXPECT_NEAR(m.vertices.colwise().norm().minCoeff(), 0.01, 1e-16);
    EXPECT_NEAR(m.vertices.colwise().norm().maxCoeff(), 0.01, 1e-16);
    const double error = exact - compute_volume(m);
    EXPECT_GT(error, 0.0);  // inscribed
    if (level > 1) {
      EXPECT_NEAR(last / error, 4.0, 0.3) << level;  // second order in the edge length
    }
    last = error;
  }
}

TEST(ToolShape, CapsuleHasTheVolumeOfItsParts) {
  const double r = 0.004;
  const double length = 0.02;
  const mesh::TriangleMesh m = make_capsule_tool(r, length, 64);
  EXPECT_NO_THROW(require_closed_surface(m, "capsule"));
  const double exact = std::numbers::pi * r * r * (length + 4.0 / 3.0 * r);
  EXPECT_NEAR(compute_volume(m) / exact, 1.0, 0.005);  // chords of 64 pieces: 2π²/(3·64²) and the same again
  EXPECT_NEAR(m.vertices.row(2).minCoeff(), -r, 1e-15);
  EXPECT_NEAR(m.vertices.row(2).maxCoeff(), length + r, 1e-15);
}

TEST(ToolShape, StylusHasARoundTipThatMeetsItsConeSmoothly) {
  const mesh::TriangleMesh m = make_stylus_tool(0.002, 0.006, 0.04, 48);
  EXPECT_NO_THROW(require_closed_surface(m, "stylus"));
  EXPECT_NEAR(m.vertices.row(2).minCoeff(), -0.002, 1e-15);
  EXPECT_NEAR(m.vertices.row(2).maxCoeff(), 0.04, 1e-15);
  EXPECT_NEAR(m.vertices.topRows(2).colwise().norm().maxCoeff(), 0.006, 1e-15);
  // Tangent cone: no vertex comes nearer to the tip's centre than its radius.
  EXPECT_GE(m.vertices.leftCols(m.num_vertices() - 1).colwise().norm().minCoeff(), 0.002 * (1 - 1e-12));
}

std::string refusal(const mesh::TriangleMesh& m) {
  try {
    require_closed_surface(m, "tool.obj");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ToolShape, RefusesWhatHasNoInside) {
  const mesh::TriangleMesh good = make_sphere_tool(0.01, 1);
  mesh::TriangleMesh open = good;
  open.triangles.conservativeResize(3, good.num_triangles() - 1);
  EXPECT_NE(refusal(open).find("the surface is open"), std::string::npos) << refusal(open);
  EXPECT_EQ(refusal(open).rfind("tool.obj: edge ", 0), 0U);
  mesh::TriangleMesh flipped = good;
  flipped.triangles.col(3).reverseInPlace();
  EXPECT_NE(refusal(flipped).find("twice in the same direction"), std::string::npos);
  mesh::TriangleMesh inverted = good;
  for (int t = 0; t < inverted.num_triangles(); ++t) inverted.triangles.col(t).reverseInPlace();
  EXPECT_NE(refusal(inverted).find("normals point out"), std::string::npos);
  mesh::TriangleMesh broken = good;
  broken.vertices(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(broken).find("not a number"), std::string::npos);
  EXPECT_NE(refusal({}).find("0 triangles"), std::string::npos);
}

}  // namespace
}  // namespace argil::contact
