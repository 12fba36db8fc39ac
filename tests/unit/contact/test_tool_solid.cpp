// Signed distances of tools: closed forms, gradients, and the surfaces that draw them.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "contact/tool_shape.h"
#include "contact/tool_solid.h"

namespace argil::contact {
namespace {

constexpr RoundTool kBall{0.008, 0.0, 0.008, false};
constexpr RoundTool kCapsule{0.004, 0.02, 0.004, false};
constexpr RoundTool kStylus{0.001, 0.03, 0.005, true};

double distance(ToolSolid& tool, const Vec3& p) {
  int face = 0;
  return tool.find_distance(p, face).distance;
}

struct RoundCase {
  std::string name;
  RoundTool shape;
  mesh::TriangleMesh surface;
  double sagitta;  // how far the facets lie inside
};

const std::vector<RoundCase>& round_cases() {
  static const std::vector<RoundCase> cases = {
      {"ball", kBall, make_sphere_tool(0.008, 4), 0.008 * 0.003},
      {"capsule", kCapsule, make_capsule_tool(0.004, 0.02, 64), 0.004 * 0.005},
      {"stylus", kStylus, make_stylus_tool(0.001, 0.005, 0.03, 96), 0.005 * 0.002}};
  return cases;
}

TEST(ToolSolid, BallAndCapsuleHaveTheirClosedForms) {
  ToolSolid ball(kBall);
  EXPECT_NEAR(distance(ball, {0.003, 0.004, 0.0}), -0.003, 1e-15);
  EXPECT_NEAR(distance(ball, {0.0, 0.0, -0.01}), 0.002, 1e-15);
  ToolSolid capsule(kCapsule);
  EXPECT_NEAR(distance(capsule, {0.006, 0.0, 0.01}), 0.002, 1e-15);
  EXPECT_NEAR(distance(capsule, {0.0, 0.003, 0.015}), -0.001, 1e-15);
  EXPECT_NEAR(distance(capsule, {0.0, 0.0, -0.005}), 0.001, 1e-15);
  EXPECT_NEAR(distance(capsule, {0.003, 0.0, 0.024}), 0.001, 1e-15);
}

TEST(ToolSolid, StylusIsABallAConeAndADisc) {
  ToolSolid stylus(kStylus);
  EXPECT_NEAR(distance(stylus, {0.0, 0.0, -0.003}), 0.002, 1e-15);
  EXPECT_NEAR(distance(stylus, {0.0, 0.0, 0.033}), 0.003, 1e-15);
  EXPECT_NEAR(distance(stylus, {0.0, 0.0, 0.0295}), -0.0005, 1e-15);
  EXPECT_NEAR(distance(stylus, {0.005 + 0.003, 0.0, 0.03 + 0.004}), 0.005, 1e-15);  // from the rim
  // The cone goes through the rim and lies a tip's radius from the origin: on it halfway, and 1 mm beside.
  const double angle = std::acos(0.001 / std::hypot(0.005, 0.03)) - std::atan2(0.03, 0.005);
  const Vec3 normal(std::cos(angle), 0.0, -std::sin(angle));
  const Vec3 foot = 0.001 * normal;
  const Vec3 middle = 0.5 * (foot + Vec3(0.005, 0.0, 0.03));
  EXPECT_NEAR(distance(stylus, middle), 0.0, 1e-15);
  EXPECT_NEAR(distance(stylus, middle + 0.001 * normal), 0.001, 1e-15);
  EXPECT_NEAR(distance(stylus, middle - 0.001 * normal), -0.001, 1e-15);
}

TEST(ToolSolid, ExactShapesAreThoseThatAreDrawn) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.012, 0.036);
  for (const RoundCase& c : round_cases()) {
    ToolSolid exact(c.shape);
    ToolSolid drawn(c.surface);
    for (int i = 0; i < 400; ++i) {
      const Vec3 p(0.5 * place(random), 0.5 * place(random), place(random));
      const double d = distance(exact, p);
      EXPECT_NEAR(distance(drawn, p), d + 0.5 * c.sagitta, 0.5 * c.sagitta + 1e-12)
          << c.name << " " << p.transpose();
    }
  }
}

TEST(ToolSolid, GradientIsThatOfTheDistance) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.012, 0.036);
  std::vector<ToolSolid> tools;
  for (const RoundCase& c : round_cases()) tools.emplace_back(c.shape);
  tools.emplace_back(make_sphere_tool(0.008, 1));
  for (ToolSolid& tool : tools) {
    int num_kinks = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 p(0.5 * place(random), 0.5 * place(random), place(random));
      int face = 0;
      const ToolDistance found = tool.find_distance(p, face);
      EXPECT_NEAR(found.outward.norm(), 1.0, 1e-12);
      constexpr double kStep = 1e-8;
      Vec3 gradient;
      for (int k = 0; k < 3; ++k)
        gradient(k) =
            (distance(tool, p + kStep * Vec3::Unit(k)) - distance(tool, p - kStep * Vec3::Unit(k))) /
            (2.0 * kStep);
      if ((gradient - found.outward).norm() > 1e-5) ++num_kinks;  // where two places are equally near
    }
    EXPECT_LE(num_kinks, 3);
  }
}

TEST(ToolSolid, ChangesByNoMoreThanThePointMoves) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> place(-0.02, 0.05);
  for (const RoundCase& c : round_cases()) {
    ToolSolid tool(c.shape);
    EXPECT_LE((Vec3(0.0, 0.0, -c.shape.tip_radius) - tool.centre()).norm(), tool.radius() * (1 + 1e-12));
    for (int i = 0; i < 10000; ++i) {
      const Vec3 p(place(random), place(random), place(random));
      const Vec3 q(place(random), place(random), place(random));
      EXPECT_LE(std::abs(distance(tool, p) - distance(tool, q)), (p - q).norm() * (1 + 1e-12)) << c.name;
      EXPECT_GE(distance(tool, p), (p - tool.centre()).norm() - tool.radius() - 1e-15) << c.name;
    }
  }
}

/// Cube of side 2 about the origin.
mesh::TriangleMesh make_cube() {
  mesh::TriangleMesh cube;
  cube.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) cube.vertices.col(i) << (i & 1) * 2 - 1, (i >> 1 & 1) * 2 - 1, (i >> 2) * 2 - 1;
  cube.triangles.resize(3, 12);
  cube.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return cube;
}

TEST(ToolSolid, ACubeHasItsFacesEdgesAndCorners) {
  require_closed_surface(make_cube(), "cube");
  ToolSolid cube(make_cube());
  EXPECT_NEAR(distance(cube, {0.2, 0.1, 1.5}), 0.5, 1e-14);
  EXPECT_NEAR(distance(cube, {0.2, 0.1, 0.7}), -0.3, 1e-14);
  EXPECT_NEAR(distance(cube, {1.3, 0.1, 1.4}), 0.5, 1e-14);
  EXPECT_NEAR(distance(cube, {1.2, 1.2, 1.1}), 0.3, 1e-14);
  EXPECT_NEAR(distance(cube, {-0.9, -0.95, 0.2}), -0.05, 1e-14);
  int face = 0;
  EXPECT_NEAR((cube.find_distance({1.3, 0.0, 1.4}, face).outward - Vec3(0.6, 0.0, 0.8)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((cube.find_distance({0.1, 0.2, 1.0}, face).outward - Vec3::UnitZ()).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace argil::contact
