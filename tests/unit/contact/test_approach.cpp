// How near a tool comes along a motion: distances from a slab and from its edges and corners by hand, depths,
// the slowest way of finding them, and what moving all of it does.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "contact/approach.h"
#include "contact/tool_shape.h"
#include "scenes.h"

namespace argil::contact {
namespace {

constexpr RoundTool kBall{0.008, 0.0, 0.008, false};
constexpr RoundTool kCapsule{0.004, 0.02, 0.004, false};
constexpr RoundTool kStylus{0.001, 0.03, 0.005, true};
constexpr double kRight = 2e-8;  // [m]: ApproachFinder::kTolerance of the tools' thickness

const mesh::TriangleMesh& slab() {  // |x|, |y| ≤ 50 mm, −20 mm ≤ z ≤ 0
  static const mesh::TriangleMesh mesh = test::make_flat_slab();
  return mesh;
}

Quat turned(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis));
}

Approach find_at(ToolSolid tool, const Vec3& position, const Quat& orientation = Quat::Identity()) {
  const Pose pose{position, orientation};
  return ApproachFinder(slab(), std::move(tool)).find(std::span(&pose, 1));
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " is not " << b.transpose();
}

TEST(Approach, OfABallIsItsMiddlesDistanceLessItsRadius) {
  const Approach above = find_at(ToolSolid(kBall), {0.01, 0.02, 0.03});
  EXPECT_NEAR(above.distance, 0.022, kRight);
  expect_near(above.on_body, {0.01, 0.02, 0.0}, 1e-9);
  expect_near(above.to_body, {0.0, 0.0, -1.0}, 1e-9);
  // 30 and 40 mm beside an edge, then 20, 30 and 60 mm beside a corner: 70 mm.
  EXPECT_NEAR(find_at(ToolSolid(kBall), {0.08, 0.0, 0.04}).distance, 0.05 - 0.008, kRight);
  const Approach corner = find_at(ToolSolid(kBall), {0.07, -0.08, 0.06});
  EXPECT_NEAR(corner.distance, 0.07 - 0.008, kRight);
  expect_near(corner.on_body, {0.05, -0.05, 0.0}, 1e-9);
  expect_near(corner.to_body, Vec3(-2.0, 3.0, -6.0) / 7.0, 1e-9);
}

TEST(Approach, OfABallIsItsDepthAlsoWhereItsMiddleIsInside) {
  const Approach half = find_at(ToolSolid(kBall), {0.01, 0.02, 0.003});
  EXPECT_NEAR(half.distance, -0.005, kRight);
  expect_near(half.to_body, {0.0, 0.0, -1.0}, 1e-9);
  const Approach inside = find_at(ToolSolid(kBall), {0.01, 0.02, -0.006});
  EXPECT_NEAR(inside.distance, -0.014, kRight);
  expect_near(inside.on_body, {0.01, 0.02, 0.0}, 1e-9);
  expect_near(inside.to_body, {0.0, 0.0, -1.0}, 1e-9);
}

TEST(Approach, OfACapsuleIsThatOfItsAxis) {
  // Upright, lying, and leaning: then the end at the tip is the lower one.
  EXPECT_NEAR(find_at(ToolSolid(kCapsule), {0.0, 0.0, 0.03}).distance, 0.026, kRight);
  const Quat lying = turned(0.5 * std::numbers::pi, Vec3::UnitY());
  EXPECT_NEAR(find_at(ToolSolid(kCapsule), {0.0, 0.01, 0.003}, lying).distance, -0.001, kRight);
  const Quat down = turned(0.75 * std::numbers::pi, Vec3::UnitY());
  EXPECT_NEAR(find_at(ToolSolid(kCapsule), {0.0, 0.01, 0.03}, down).distance,
              0.03 - 0.02 * std::sqrt(0.5) - 0.004, kRight);
  // From one end to the other across an edge, at 45°, its middle 10 mm away from it.
  const double s = std::sqrt(0.5);
  const Vec3 middle(0.05 + 0.01 * s, 0.0, 0.01 * s);
  const Quat across = turned(0.75 * std::numbers::pi, Vec3::UnitY());  // along (s, 0, −s)
  const Approach edge = find_at(ToolSolid(kCapsule), middle - 0.01 * Vec3(s, 0.0, -s), across);
  EXPECT_NEAR(edge.distance, 0.01 - 0.004, kRight);
  EXPECT_NEAR(edge.on_body.x(), 0.05, 1e-5);
  EXPECT_NEAR(edge.on_body.z(), 0.0, 1e-5);
}

TEST(Approach, OfAStylusIsThatOfItsTipOrItsEnd) {
  EXPECT_NEAR(find_at(ToolSolid(kStylus), {0.0, 0.0, 0.0004}).distance, -0.0006, kRight);
  const Quat upside_down = turned(std::numbers::pi, Vec3::UnitX());
  EXPECT_NEAR(find_at(ToolSolid(kStylus), {0.0, 0.0, 0.05}, upside_down).distance, 0.02, kRight);
  EXPECT_NEAR(find_at(ToolSolid(kStylus), {0.0, 0.0, 0.0295}, upside_down).distance, -0.0005, kRight);
}

TEST(Approach, OfAToolInsideTheBodyIsBelowZero) {
  // Its axis goes from 6 to 14 mm below the top, through the slab's middle: 10 mm and the radius.
  const RoundTool small{0.002, 0.008, 0.002, false};
  EXPECT_NEAR(find_at(ToolSolid(small), {0.0, 0.0, -0.014}).distance, -0.012, kRight);
}

/// Vertices, places on edges and within faces, from a fine grid over each triangle.
double find_slowly(ToolSolid tool, const mesh::TriangleMesh& body, const Pose& pose, int n) {
  double least = std::numeric_limits<double>::infinity();
  int face = 0;
  for (Eigen::Index t = 0; t < body.triangles.cols(); ++t)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 x =
            (i * body.vertices.col(body.triangles(0, t)) + j * body.vertices.col(body.triangles(1, t)) +
             (n - i - j) * body.vertices.col(body.triangles(2, t))) /
            n;
        least = std::min(
            least, tool.find_distance(pose.orientation.conjugate() * (x - pose.position), face).distance);
      }
  return least;
}

TEST(Approach, IsTheLeastOverAFineGridOfTheSurface) {
  const mesh::TriangleMesh body = test::make_slab(
      4, 0.04, 0.01, [](double x, double y) { return 0.01 * std::sin(100.0 * x) * std::cos(120.0 * y); });
  const double grid = 0.023 / 24.0;  // longest edge over the pieces: a place on the surface has one as near
  Rng rng(7, "approach");
  const std::vector<std::pair<RoundTool, mesh::TriangleMesh>> tools = {
      {kCapsule, make_capsule_tool(0.004, 0.02, 12)}, {kStylus, make_stylus_tool(0.001, 0.005, 0.03, 12)}};
  for (int trial = 0; trial < 10; ++trial)
    for (const auto& [round, drawn] : tools)
      for (const bool is_mesh : {false, true}) {
        const auto make = [&] { return is_mesh ? ToolSolid(drawn) : ToolSolid(round); };
        const Vec3 axis(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
        const Pose pose{{rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), rng.uniform(0.012, 0.04)},
                        turned(rng.uniform(0.0, 1.0), axis.normalized())};
        const double found = ApproachFinder(body, make()).find(std::span(&pose, 1)).distance;
        const double slow = find_slowly(make(), body, pose, 24);
        EXPECT_LE(found, slow + kRight) << trial << ' ' << is_mesh;
        EXPECT_GE(found, slow - grid) << trial << ' ' << is_mesh;
      }
}

std::vector<Pose> make_way(std::size_t count) {
  std::vector<Pose> way;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count - 1);
    way.push_back({Vec3(0.07 * t - 0.03, 0.01 * std::sin(9.0 * t), 0.03 - 0.05 * std::sin(7.0 * t) * t),
                   turned(2.0 * t, Vec3(0.6, 0.0, 0.8))});
  }
  return way;
}

TEST(Approach, AlongAWayIsTheLeastOfItsPoses) {
  const std::vector<Pose> way = make_way(150);
  for (const auto& [round, drawn] :
       {std::pair{kBall, make_sphere_tool(0.008, 1)}, std::pair{kCapsule, make_capsule_tool(0.004, 0.02, 8)}})
    for (const bool is_mesh : {false, true}) {
      ApproachFinder finder(slab(), is_mesh ? ToolSolid(drawn) : ToolSolid(round));
      const Approach found = finder.find(way);
      double least = std::numeric_limits<double>::infinity();
      for (const Pose& pose : way) least = std::min(least, finder.find(std::span(&pose, 1)).distance);
      EXPECT_NEAR(found.distance, least, kRight);
      EXPECT_NEAR(finder.find(std::span(&way[found.pose], 1)).distance, found.distance, kRight);
      EXPECT_LE(finder.find(way, Vec3::Zero(), 0.0).distance, 0.0);
    }
}

TEST(Approach, MovesAndTurnsWithToolAndBody) {
  const std::vector<Pose> way = make_way(100);
  const Quat turn = turned(1.1, Vec3(0.36, 0.48, 0.8));
  const Vec3 shift(0.3, -0.2, 0.1);
  mesh::TriangleMesh moved = slab();
  moved.vertices = (turn.toRotationMatrix() * moved.vertices).colwise() + shift;
  std::vector<Pose> moved_way = way;
  for (Pose& pose : moved_way) pose = {turn * pose.position + shift, turn * pose.orientation};
  for (const RoundTool& round : {kBall, kCapsule, kStylus}) {
    const Approach one = ApproachFinder(slab(), ToolSolid(round)).find(way);
    const Approach other = ApproachFinder(moved, ToolSolid(round)).find(moved_way);
    EXPECT_NEAR(one.distance, other.distance, kRight);
    expect_near(turn * one.to_body, other.to_body, 1e-3);
  }
}

TEST(Approach, IsBroughtToADepth) {
  // At 60° to the slab: the ball's middle has to end 6 mm above it.
  const std::vector<Pose> way = {{Vec3(0.0, 0.0, 0.5), Quat::Identity()},
                                 {Vec3(-0.2, 0.0, 0.3), Quat::Identity()}};
  const Vec3 direction(0.5, 0.0, -std::sqrt(0.75));
  ApproachFinder ball(slab(), ToolSolid(kBall));
  const auto shift = ball.find_shift(way, Vec3::Zero(), direction, 0.002, 1.0);
  ASSERT_TRUE(shift.has_value());
  EXPECT_NEAR(*shift, (0.3 - 0.006) / std::sqrt(0.75), 1e-7);
  EXPECT_NEAR(ball.find(way, *shift * direction).distance, -0.002, 1e-7);
  // Beside it, it never comes.
  EXPECT_FALSE(ball.find_shift(way, {0.2, 0.2, 0.0}, {0.0, 0.0, -1.0}, 0.002, 1.0).has_value());
}

}  // namespace
}  // namespace argil::contact
