// Signed distances of tools: closed forms, gradients, and the surfaces that draw them.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/rng.h"
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

Vec3 draw_point(Rng& rng, double low, double high) {
  return {rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high)};
}

/// Signed distance of the convex hull of a ball of radius r about the origin and a disc of radius R at height
/// L: max over unit n of n·p − h(n), with its support h(n) = max(r, R |n_r| + L n_z).
double compute_hull_distance(const RoundTool& tool, const Vec3& p) {
  const double from_axis = std::hypot(p.x(), p.y());
  const auto height = [&](double angle) {
    const double n_r = std::cos(angle), n_z = std::sin(angle);
    const double end =
        tool.is_flat ? tool.end_radius * n_r + tool.length * n_z : tool.length * n_z + tool.tip_radius;
    return n_r * from_axis + n_z * p.z() - std::max(tool.tip_radius, end);
  };
  constexpr int kAngles = 720;
  constexpr double kRight = 0.5 * std::numbers::pi;
  int best = 0;
  for (int i = 1; i <= kAngles; ++i)
    if (height(kRight * (2.0 * i / kAngles - 1.0)) > height(kRight * (2.0 * best / kAngles - 1.0))) best = i;
  double low = kRight * (2.0 * std::max(0, best - 1) / kAngles - 1.0);
  double high = kRight * (2.0 * std::min(kAngles, best + 1) / kAngles - 1.0);
  for (int i = 0; i < 80; ++i) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (height(a) < height(b) ? low : high) = height(a) < height(b) ? a : b;
  }
  return height(0.5 * (low + high));
}

TEST(ToolSolid, RoundShapesHaveTheDistanceOfTheirSupportFunction) {
  Rng rng(17);
  for (const RoundTool& shape : {kBall, kCapsule, kStylus, RoundTool{0.002, 0.003, 0.009, true}}) {
    ToolSolid tool(shape);
    for (int i = 0; i < 3000; ++i) {
      Vec3 p = draw_point(rng, -1.0, 1.0);
      p = Vec3(0.012 * p.x(), 0.012 * p.y(), 0.5 * shape.length + (0.5 * shape.length + 0.012) * p.z());
      int face = 0;
      const ToolDistance found = tool.find_distance(p, face);
      ASSERT_NEAR(found.distance, compute_hull_distance(shape, p), 1e-12)
          << shape.length << " " << p.transpose();
      ASSERT_NEAR(found.outward.norm(), 1.0, 1e-12);
      // The way out leads to the surface.
      ASSERT_NEAR(distance(tool, p - found.distance * found.outward), 0.0, 1e-12) << p.transpose();
    }
  }
}

/// Inside and outside a cube of side 2, also on its faces' planes.
TEST(ToolSolid, ACubeIsExactEverywhere) {
  Rng rng(19);
  ToolSolid cube(make_cube());
  for (int i = 0; i < 10000; ++i) {
    Vec3 p = draw_point(rng, -2.5, 2.5);
    for (int k = 0; k < 3; ++k)
      if (rng.uniform(0.0, 1.0) < 0.2) p(k) = std::round(p(k));
    const Vec3 beyond = p.cwiseAbs() - Vec3::Ones();
    const double expected = beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
    int face = static_cast<int>(rng.uniform(0.0, 12.0));
    const ToolDistance found = cube.find_distance(p, face);
    ASSERT_NEAR(found.distance, expected, 1e-14) << p.transpose();
    ASSERT_NEAR(found.outward.norm(), 1.0, 1e-12) << p.transpose();
    const Vec3 foot = p - found.distance * found.outward;
    ASSERT_NEAR((foot.cwiseAbs() - Vec3::Ones()).maxCoeff(), 0.0, 1e-12) << p.transpose();
  }
}

double compute_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// Least distance from all triangles; negative where their solid angles sum to 4π [vanOosterom1983].
double compute_slow_distance(const mesh::TriangleMesh& surface, const Vec3& p) {
  double least = 1e300;
  double angle = 0.0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    std::array<Vec3, 3> x;
    for (Eigen::Index k = 0; k < 3; ++k)
      x[static_cast<std::size_t>(k)] = surface.vertices.col(surface.triangles(k, t));
    const Vec3 n = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
    bool is_over = true;
    for (std::size_t k = 0; k < 3; ++k) {
      least = std::min(least, compute_distance_to_segment(p, x[k], x[(k + 1) % 3]));
      is_over = is_over && n.dot((x[(k + 1) % 3] - x[k]).cross(p - x[k])) >= 0.0;
    }
    if (is_over) least = std::min(least, std::abs(n.dot(p - x[0])));
    const Vec3 a = x[0] - p, b = x[1] - p, c = x[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * std::numbers::pi ? -least : least;
}

/// A star with spikes and dents: sharp edges and corners of all kinds.
TEST(ToolSolid, AMeshHasTheDistanceOfAllItsTriangles) {
  Rng rng(23);
  mesh::TriangleMesh star = make_sphere_tool(1.0, 2);
  for (Eigen::Index v = 0; v < star.vertices.cols(); ++v) star.vertices.col(v) *= rng.uniform(0.4, 1.0);
  require_closed_surface(star, "star");
  ToolSolid tool(star);
  int guess = 0, num_inside = 0;
  Vec3 last = Vec3::Zero();
  double last_distance = distance(tool, last);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 p = draw_point(rng, -1.1, 1.1);
    const ToolDistance found = tool.find_distance(p, guess);
    ASSERT_NEAR(found.distance, compute_slow_distance(star, p), 1e-12) << p.transpose();
    ASSERT_NEAR(found.outward.norm(), 1.0, 1e-12);
    ASSERT_NEAR(distance(tool, p - found.distance * found.outward), 0.0, 1e-9) << p.transpose();
    ASSERT_LE(std::abs(found.distance - last_distance), (p - last).norm() * (1.0 + 1e-12));
    num_inside += found.distance < 0.0 ? 1 : 0;
    last = p;
    last_distance = found.distance;
  }
  EXPECT_GT(num_inside, 500);
}

/// Where many places are equally near, any of them is a way out.
TEST(ToolSolid, OnItsAxisAndRimTheWayOutLeadsOut) {
  for (const RoundTool& shape : {kBall, kCapsule, kStylus}) {
    ToolSolid tool(shape);
    std::vector<Vec3> places;
    for (int i = 0; i <= 10; ++i) places.emplace_back(0.0, 0.0, 0.1 * i * shape.length);
    if (shape.is_flat) places.emplace_back(shape.end_radius, 0.0, shape.length);
    for (const Vec3& p : places) {
      int face = 0;
      const ToolDistance found = tool.find_distance(p, face);
      EXPECT_NEAR(distance(tool, p - (found.distance - 1e-4) * found.outward), 1e-4, 1e-12)
          << shape.length << " " << p.transpose();
    }
  }
}

}  // namespace
}  // namespace argil::contact
