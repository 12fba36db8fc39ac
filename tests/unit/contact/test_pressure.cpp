// Pressure over the touched surface: closed forms, and answers that do not depend on triangles, place or
// frame.

#include "contact/pressure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "contact/tool_shape.h"
#include "unit/contact/pressure_scenes.h"

namespace argil::contact {
namespace {

using test::kBall;
using test::kModulus;
using test::kRadius;
using test::kStiffness;
using test::make_contact;
using test::make_flat_slab;
using test::press;

Contacts press(const mesh::TriangleMesh& body, const Vec3& position, Yielding yielding) {
  return press(body, ToolSolid(kBall), Pose{position}, yielding);
}

double compute_hertz(double depth) {
  return 4.0 / 3.0 * kModulus * std::sqrt(kRadius) * std::pow(depth, 1.5);
}

/// κ ∫ depth (outward·z) dA of a ball whose lowest point is `depth` below a plane, along the plane's normal.
double compute_penalty_force(double depth) {
  constexpr int kRings = 20000;
  const double height = kRadius - depth;  // of the centre
  const double rim = std::sqrt(kRadius * kRadius - height * height);
  double sum = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double r = rim * (i + 0.5) / kRings;
    const double from_centre = std::hypot(r, height);
    sum += 2.0 * std::numbers::pi * r * rim / kRings * (kRadius - from_centre) * height / from_centre;
  }
  return kStiffness * sum;
}

TEST(HeldPressure, IsHertzUnderABall) {
  const mesh::TriangleMesh plane = make_flat_slab(20);
  for (const double depth : {0.0002, 0.0004, 0.0008, 0.0016, 0.0024}) {
    const Contacts found = press(plane, {0.0011, 0.0023, kRadius - depth}, Yielding::no);
    EXPECT_NEAR(found.force_on_tool.z() / compute_hertz(depth), 1.0, 0.05) << depth;
    EXPECT_LT(found.force_on_tool.head<2>().norm(), 0.01 * found.force_on_tool.z()) << depth;
  }
}

TEST(HeldPressure, DoesNotCountTriangles) {
  const double depth = 0.001;
  const double expected = compute_hertz(depth);
  for (const int n : {2, 5, 10, 20, 40, 80, 160})
    EXPECT_NEAR(press(make_flat_slab(n), {0.0011, 0.0023, kRadius - depth}, Yielding::no).force_on_tool.z() /
                    expected,
                1.0, 0.025)
        << n;
}

TEST(HeldPressure, IsTheSameWhereverTheToolStands) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.02, 0.02);
  for (const int n : {5, 20, 60}) {
    const mesh::TriangleMesh plane = make_flat_slab(n);
    std::vector<double> forces;
    for (int i = 0; i < 20; ++i)
      forces.push_back(
          press(plane, {place(random), place(random), kRadius - 0.001}, Yielding::no).force_on_tool.z());
    const auto [least, most] = std::minmax_element(forces.begin(), forces.end());
    EXPECT_LT((*most - *least) / *most, 0.015) << n;
  }
}

TEST(HeldPressure, IsThatOfTheBallForItsMeshes) {
  const mesh::TriangleMesh plane = make_flat_slab(20);
  const Pose pose{{0.0011, 0.0023, kRadius - 0.002}};
  const double exact = press(plane, ToolSolid(kBall), pose, Yielding::no).force_on_tool.z();
  for (const auto& [level, bound] : {std::pair{3, 0.03}, std::pair{4, 0.01}, std::pair{5, 0.01}})
    EXPECT_NEAR(
        press(plane, ToolSolid(make_sphere_tool(kRadius, level)), pose, Yielding::no).force_on_tool.z() /
            exact,
        1.0, bound)
        << level;
}

TEST(Pressure, IsStiffnessTimesDepthOverTheArea) {
  for (const int n : {5, 20, 80, 160})
    for (const double depth : {0.0005, 0.002}) {
      const Contacts found = press(make_flat_slab(n), {0.0011, 0.0023, kRadius - depth}, Yielding::yes);
      EXPECT_NEAR(found.force_on_tool.z() / compute_penalty_force(depth), 1.0, 0.03) << n << " " << depth;
    }
}

/// A tip inside a face that is twenty times as large is felt as on its corner or its edge.
TEST(Pressure, FeelsATipWhereverItMeetsALargeFace) {
  const mesh::TriangleMesh plane = make_flat_slab(5);
  const RoundTool tip{0.001, 0.03, 0.003, true};
  const std::vector<Vec3> places = {
      {0.01, 0.01, 0.0}, {0.01, 0.003, 0.0}, {0.0033, 0.0033, 0.0}, {0.0, 0.0, 0.0}, {0.004, 0.0013, 0.0}};
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    std::vector<double> forces;
    for (const Vec3& place : places)
      forces.push_back(
          press(plane, ToolSolid(tip), Pose{place + Vec3(0.0, 0.0, 0.0008)}, yielding).force_on_tool.z());
    const auto [least, most] = std::minmax_element(forces.begin(), forces.end());
    EXPECT_GT(*least, 0.0);
    EXPECT_LT((*most - *least) / *most, 0.05);
  }
}

TEST(Pressure, TurnsMirrorsAndScalesWithTheScene) {
  const mesh::TriangleMesh hill =
      test::make_slab(16, 0.1, 0.02, [](double x, double y) { return 0.004 * std::cos(60 * x + 20 * y); });
  const RoundTool capsule{0.004, 0.02, 0.004, false};
  const Pose pose{{0.003, -0.002, 0.0065}, Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()))};
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    const Contacts plain = press(hill, ToolSolid(capsule), pose, yielding);
    ASSERT_GT(plain.force_on_tool.norm(), 0.0);
    const Quat turn(Eigen::AngleAxisd(1.1, Vec3(-2, 1, 1).normalized()));
    const Vec3 shift(0.3, -0.2, 0.1);
    mesh::TriangleMesh turned = hill;
    for (Eigen::Index v = 0; v < turned.vertices.cols(); ++v)
      turned.vertices.col(v) = turn * Vec3(hill.vertices.col(v)) + shift;
    const Contacts other = press(turned, ToolSolid(capsule),
                                 Pose{turn * pose.position + shift, turn * pose.orientation}, yielding);
    EXPECT_LT((other.force_on_tool - turn * plain.force_on_tool).norm(), 1e-9 * plain.force_on_tool.norm());
    EXPECT_LT((other.torque_on_tool - turn * plain.torque_on_tool).norm(),
              1e-9 * plain.force_on_tool.norm() * kRadius);

    mesh::TriangleMesh large = hill;  // κ is per length, E* is not: forces grow with the cube or the square
    large.vertices *= 10.0;
    const Contacts grown = press(large, ToolSolid(RoundTool{0.04, 0.2, 0.04, false}),
                                 Pose{10.0 * pose.position, pose.orientation}, yielding);
    const double scale = yielding == Yielding::yes ? 1000.0 : 100.0;
    EXPECT_LT((grown.force_on_tool - scale * plain.force_on_tool).norm(), 1e-9 * grown.force_on_tool.norm());

    mesh::TriangleMesh mirrored = hill;
    mirrored.vertices.row(0) *= -1.0;
    mirrored.triangles.row(0).swap(mirrored.triangles.row(1));
    const Vec3 axis = pose.orientation * Vec3::UnitZ();  // all that a capsule's turn is
    const Quat reflected = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(-axis.x(), axis.y(), axis.z()));
    const Contacts image =
        press(mirrored, ToolSolid(capsule), Pose{{-0.003, -0.002, 0.0065}, reflected}, yielding);
    EXPECT_LT((image.force_on_tool - Vec3(-1, 1, 1).cwiseProduct(plain.force_on_tool)).norm(),
              1e-9 * plain.force_on_tool.norm());
  }
}

TEST(Pressure, DoesNotDependOnNumbers) {
  const mesh::TriangleMesh plane = make_flat_slab(16);
  std::mt19937 random(5);
  std::vector<int> number(static_cast<std::size_t>(plane.num_vertices()));
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  mesh::TriangleMesh other = plane;
  for (int v = 0; v < plane.num_vertices(); ++v)
    other.vertices.col(number[static_cast<std::size_t>(v)]) = plane.vertices.col(v);
  for (Eigen::Index t = 0; t < plane.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      other.triangles((k + 1) % 3, plane.triangles.cols() - 1 - t) =
          number[static_cast<std::size_t>(plane.triangles(k, t))];
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    const Vec3 place(0.0011, 0.0023, kRadius - 0.0015);
    const Contacts a = press(plane, place, yielding);
    const Contacts b = press(other, place, yielding);
    EXPECT_LT((a.force_on_tool - b.force_on_tool).norm(), 1e-9 * a.force_on_tool.norm());
    EXPECT_LT((a.torque_on_tool - b.torque_on_tool).norm(), 1e-9 * a.force_on_tool.norm() * kRadius);
  }
}

TEST(Pressure, ActsAndReacts) {
  const mesh::TriangleMesh plane = make_flat_slab(12);
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    const Vec3 place(0.0011, 0.0023, kRadius - 0.002);
    const Contacts found = press(plane, place, yielding);
    const auto [force, moment] = test::sum_body_forces(found, plane.vertices, place);
    EXPECT_LT((force + found.force_on_tool).norm(), 1e-12 * force.norm());
    EXPECT_LT((moment + found.torque_on_tool).norm(), 1e-12 * force.norm() * kRadius);
  }
}

TEST(Pressure, LeavesOutTheFarSideOfAThinPlate) {
  const mesh::TriangleMesh plate = make_flat_slab(20, 0.1, 0.0005);  // its underside lies in the ball, too
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    const double thin = press(plate, {0.001, 0.002, kRadius - 0.002}, yielding).force_on_tool.z();
    const double thick =
        press(make_flat_slab(20), {0.001, 0.002, kRadius - 0.002}, yielding).force_on_tool.z();
    EXPECT_NEAR(thin / thick, 1.0, 1e-6);
    EXPECT_NEAR(press(plate, {0.001, 0.002, -0.0005 - kRadius + 0.002}, yielding).force_on_tool.z() / thick,
                -1.0, 0.01);
  }
}

/// Steps of 4 µm: the splitting of triangles changes by degrees.
TEST(Pressure, HasNoJumpAsTheToolGoesDown) {
  for (const Yielding yielding : {Yielding::yes, Yielding::no})
    for (const int n : {4, 20, 60}) {
      const mesh::TriangleMesh plane = make_flat_slab(n);
      PressureContact pressure = make_contact(plane, ToolSolid(kBall));
      Contacts contacts;
      std::vector<double> forces;
      for (int i = 0; i <= 750; ++i) {
        const Pose pose{{0.0011, 0.0023, kRadius - 4e-6 * i}};
        pressure.find_contacts(plane.vertices, pose, pose, yielding, contacts);
        forces.push_back(contacts.force_on_tool.z());
      }
      double largest = 0.0;  // change of the change
      for (std::size_t i = 2; i < forces.size(); ++i)
        largest = std::max(largest, std::abs(forces[i] - 2 * forces[i - 1] + forces[i - 2]));
      EXPECT_LT(largest / forces.back(), 0.01) << n;
    }
}

TEST(Pressure, MeetsWhatATickPassesThrough) {
  const mesh::TriangleMesh plate = make_flat_slab(20, 0.1, 0.001);
  PressureContact pressure = make_contact(plate, ToolSolid(kBall));
  Contacts contacts;
  pressure.find_contacts(plate.vertices, Pose{{0.001, 0.002, 0.05}}, Pose{{0.001, 0.002, -0.05}},
                         Yielding::yes, contacts);
  ASSERT_FALSE(contacts.contacts.empty());
  for (const Contact& c : contacts.contacts) EXPECT_TRUE(c.passes);
}

TEST(Pressure, IsAMeanOverTheWay) {
  const mesh::TriangleMesh plane = make_flat_slab(40);
  PressureContact pressure = make_contact(plane, ToolSolid(kBall));
  Contacts contacts;
  const Vec3 high(0.001, 0.002, kRadius - 0.001);
  const Vec3 low(0.001, 0.002, kRadius - 0.002);
  pressure.find_contacts(plane.vertices, Pose{high}, Pose{low}, Yielding::yes, contacts);
  double mean = 0.0;
  constexpr int kPlaces = 200;
  for (int i = 0; i < kPlaces; ++i)
    mean += compute_penalty_force(0.001 + 0.001 * (i + 0.5) / kPlaces) / kPlaces;
  EXPECT_NEAR(contacts.force_on_tool.z() / mean, 1.0, 0.03);
}

/// What a tool passes through it meets on its way all the same.
TEST(Pressure, WithTheDiscretePenaltyIsThatOfTheEnd) {
  const mesh::TriangleMesh plane = make_flat_slab(40);
  const Eigen::Index count = plane.triangles.cols();
  const SurfaceStiffness stiffness{Field::Constant(count, kStiffness), Field::Constant(count, kModulus)};
  const Pose out{{0.001, 0.002, kRadius + 0.001}};
  const Pose high{{0.001, 0.002, kRadius - 0.001}};
  const Pose low{{0.001, 0.002, kRadius - 0.002}};
  for (const Yielding yielding : {Yielding::yes, Yielding::no}) {
    PressureContact pressure(plane.triangles, plane.num_vertices(), ToolSolid(kBall), stiffness, false,
                             PenaltyKind::discrete);
    Contacts contacts;
    const double at_low = press(plane, low.position, yielding).force_on_tool.z();
    for (const Pose& from : {out, high, low}) {
      pressure.find_contacts(plane.vertices, from, low, yielding, contacts);
      EXPECT_EQ(contacts.force_on_tool.z(), at_low);
    }
    pressure.find_contacts(plane.vertices, low, out, yielding, contacts);
    EXPECT_TRUE(contacts.contacts.empty());
    pressure.find_contacts(plane.vertices, out, Pose{{0.001, 0.002, -0.05}}, yielding, contacts);
    EXPECT_GT(contacts.force_on_tool.z(), at_low);
  }
}

/// Where it becomes larger than a triangle, too. Steps of 4 µm, in which its radius grows by 2 % at most.
TEST(Pressure, MeasuresThePatchWithoutJumps) {
  for (const int n : {4, 20, 60}) {
    const mesh::TriangleMesh plane = make_flat_slab(n);
    PressureContact pressure = make_contact(plane, ToolSolid(kBall));
    Contacts contacts;
    double before = 0.0;
    for (int i = 50; i <= 750; ++i) {
      const Pose pose{{0.0011, 0.0023, kRadius - 4e-6 * i}};
      pressure.find_contacts(plane.vertices, pose, pose, Yielding::yes, contacts);
      const double radius = pressure.find_patch().radius;
      if (before > 0.0) {
        EXPECT_NEAR(radius / before, 1.0, 0.05) << n << ' ' << i;
      }
      before = radius;
    }
  }
}

/// A ball's depth d − r²/2R below a flat triangle of the edges a, b, c is more between the corners than at
/// these by (a² + b² + c²)/24R, its mean over the triangle: h²/6R of halved squares of the side h. Triangles
/// that are not pressed as a whole bear what is missing of it. A flat face has none.
TEST(Pressure, SagsBetweenTheCornersOfSmallFaces) {
  constexpr double kDepth = 0.001;
  for (const int n : {80, 120}) {
    const mesh::TriangleMesh plane = make_flat_slab(n);
    const double side = (plane.vertices.row(0).maxCoeff() - plane.vertices.row(0).minCoeff()) / n;
    const double sag = side * side / (6.0 * kRadius);
    const auto find = [&](ToolSolid tool, const Pose& pose) {
      PressureContact pressure = make_contact(plane, std::move(tool));
      Contacts contacts;
      pressure.find_contacts(plane.vertices, pose, pose, Yielding::yes, contacts);
      double force = 0.0;
      for (const Contact& c : contacts.contacts) force += c.end_force;
      EXPECT_GT(force, 0.0);
      return pressure.find_sag(plane.vertices, force);
    };
    const double found = find(ToolSolid(kBall), Pose{{0.0011, 0.0023, kRadius - kDepth}});
    EXPECT_LT(found, 1.02 * sag) << n;
    EXPECT_GT(found, 0.85 * sag) << n;
  }
}

}  // namespace
}  // namespace argil::contact
