// Pressure over the touched surface wherever the tool stands, whatever it is drawn with, and however fast it
// comes. Expected: Hertz, Sneddon, one value for one solid, sums over the points.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/rng.h"
#include "contact/pressure.h"
#include "contact/tool_shape.h"
#include "unit/contact/pressure_scenes.h"

namespace argil::contact {
namespace {

using test::find_spread;
using test::kBall;
using test::kModulus;
using test::kRadius;
using test::kStiffness;
using test::kTip;
using test::make_contact;
using test::make_flat_slab;
using test::make_turned;
using test::Misses;
using test::press;
using test::shoot;

constexpr Yielding kBoth[] = {Yielding::yes, Yielding::no};

Quat draw_turn(Rng& rng) {
  const Vec3 axis(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
  return Quat(Eigen::AngleAxisd(rng.uniform(0.0, 3.0), axis.normalized()));
}

/// F = 2/π E* tan(α) d² of a cone of half-angle α [Sneddon1965]; its blunt sides are 25° off the surface.
TEST(HeldPressure, IsSneddonUnderACone) {
  constexpr double kHeight = 0.01;
  const double slope = std::tan(65.0 / 180.0 * std::numbers::pi);
  const mesh::TriangleMesh cone = make_turned({{slope * kHeight, kHeight}}, 96);
  require_closed_surface(cone, "cone");
  for (const double depth : {0.0005, 0.001, 0.002}) {
    const double expected = 2.0 / std::numbers::pi * kModulus * slope * depth * depth;
    const Contacts found =
        press(make_flat_slab(), ToolSolid(cone), Pose{{0.0011, 0.0023, -depth}}, Yielding::no);
    EXPECT_NEAR(found.force_on_tool.z() / expected, 1.0, 0.1) << depth;
  }
}

/// Mean distance of a drawn ball's facets from the ball that they are inscribed in, by the volume between.
double find_sagitta(const mesh::TriangleMesh& ball) {
  double volume = 0.0;
  for (Eigen::Index t = 0; t < ball.triangles.cols(); ++t) {
    const Eigen::Vector3i v = ball.triangles.col(t);
    volume +=
        Vec3(ball.vertices.col(v(0))).dot(Vec3(ball.vertices.col(v(1))).cross(ball.vertices.col(v(2)))) / 6.0;
  }
  const double whole = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);
  return (whole - volume) / (4.0 * std::numbers::pi * kRadius * kRadius);
}

/// One ball, as meshes in all positions: within a hundredth of a ball that is as much smaller as its facets
/// lie inside.
TEST(HeldPressure, OfABallsMeshDoesNotDependOnItsTurn) {
  Rng rng(3);
  const mesh::TriangleMesh plane = make_flat_slab(20);
  for (const double depth : {0.0008, 0.002})
    for (const int level : {3, 4}) {
      const Vec3 place(0.0011, 0.0023, kRadius - depth);
      const double exact = press(plane, ToolSolid(kBall), Pose{place}, Yielding::no).force_on_tool.z();
      const mesh::TriangleMesh drawn = make_sphere_tool(kRadius, level);
      const double expected = exact * std::pow(1.0 - find_sagitta(drawn) / depth, 1.5);
      for (int i = 0; i < 10; ++i) {
        const Contacts found = press(plane, ToolSolid(drawn), Pose{place, draw_turn(rng)}, Yielding::no);
        EXPECT_NEAR(found.force_on_tool.z() / expected, 1.0, 0.01) << depth << " " << level;
      }
    }
}

TEST(Pressure, OfABallsMeshDoesNotDependOnItsTurn) {
  Rng rng(3);
  const mesh::TriangleMesh plane = make_flat_slab(80);
  const Vec3 place(0.0011, 0.0023, kRadius - 0.002);
  const double exact = press(plane, ToolSolid(kBall), Pose{place}, Yielding::yes).force_on_tool.z();
  for (int i = 0; i < 10; ++i) {
    const Contacts found =
        press(plane, ToolSolid(make_sphere_tool(kRadius, 4)), Pose{place, draw_turn(rng)}, Yielding::yes);
    EXPECT_NEAR(found.force_on_tool.z() / exact, 1.0, 0.02);
  }
}

TEST(Pressure, OfAnExactBallDoesNotDependOnItsTurn) {
  Rng rng(5);
  const mesh::TriangleMesh plane = make_flat_slab(20);
  const Vec3 place(0.0011, 0.0023, kRadius - 0.001);
  for (const Yielding yielding : kBoth) {
    const Contacts plain = press(plane, ToolSolid(kBall), Pose{place}, yielding);
    for (int i = 0; i < 5; ++i) {
      const Contacts turned = press(plane, ToolSolid(kBall), Pose{place, draw_turn(rng)}, yielding);
      EXPECT_LT((turned.force_on_tool - plain.force_on_tool).norm(), 1e-12 * plain.force_on_tool.norm());
    }
  }
}

TEST(HeldPressure, IsTheSameInAnyPlace) {
  Rng rng(13);
  for (const int n : {5, 10, 20, 60}) {
    const mesh::TriangleMesh plane = make_flat_slab(n);
    std::vector<double> forces;
    for (int i = 0; i < 20; ++i) {
      const Vec3 place(rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), kRadius - 0.001);
      forces.push_back(press(plane, ToolSolid(kBall), Pose{place}, Yielding::no).force_on_tool.z());
    }
    EXPECT_LT(find_spread(forces), 0.01) << n;
  }
}

/// 1 mm tip on faces of 20 mm: over a node, an edge, a face's centre, and at random; 0.3 to 1 mm deep.
TEST(Pressure, OfAFineTipOnLargeFacesIsTheSameEverywhere) {
  Rng rng(7);
  const mesh::TriangleMesh plane = make_flat_slab(5);
  std::vector<Vec3> places = {{0.01, 0.01, 0.0}, {0.01, 0.003, 0.0}, {0.0033, 0.0033, 0.0}, {0.0, 0.0, 0.0}};
  for (int i = 0; i < 20; ++i) places.emplace_back(rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), 0.0);
  for (const Yielding yielding : kBoth)
    for (const double depth : {0.0003, 0.001}) {
      std::vector<double> forces;
      for (const Vec3& place : places)
        forces.push_back(press(plane, ToolSolid(kTip), Pose{place + Vec3(0.0, 0.0, 0.001 - depth)}, yielding)
                             .force_on_tool.z());
      EXPECT_GT(*std::min_element(forces.begin(), forces.end()), 0.0);
      EXPECT_LT(find_spread(forces), 0.05) << depth;
    }
}

/// Forces on body and tool are opposite, at the points where the contacts say; so are their moments.
TEST(Pressure, SumsToTheToolsForceAndTorque) {
  const mesh::TriangleMesh hill =
      test::make_slab(16, 0.1, 0.02, [](double x, double y) { return 0.004 * std::cos(60 * x + 20 * y); });
  const RoundTool capsule{0.004, 0.02, 0.004, false};
  const Pose from{{0.003, -0.002, 0.0075}, Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()))};
  const Pose to{{0.004, -0.001, 0.0060}, Quat(Eigen::AngleAxisd(0.5, Vec3(1, 2, 2).normalized()))};
  for (const Yielding yielding : kBoth) {
    const Contacts found = press(hill, ToolSolid(capsule), from, to, yielding);
    ASSERT_GT(found.force_on_tool.norm(), 0.1);
    Vec3 force = Vec3::Zero();
    Vec3 torque = Vec3::Zero();
    for (const Contact& c : found.contacts) {
      force += c.force;
      torque += (c.point - to.position).cross(c.force);
      Vec3 point = Vec3::Zero();
      double sum = 0.0;
      for (std::size_t k = 0; k < 3 && c.vertex[k] >= 0; ++k) {
        point += c.weight[k] * hill.vertices.col(c.vertex[k]);
        sum += c.weight[k];
      }
      ASSERT_NEAR(sum, 1.0, 1e-12);
      ASSERT_LT((point - c.point).norm(), 1e-15);
      ASSERT_NEAR(c.normal.norm(), 1.0, 1e-12);
      ASSERT_LT(c.force.cross(c.normal).norm(), 1e-12 * c.force.norm() + 1e-300);
    }
    EXPECT_LT((force + found.force_on_tool).norm(), 1e-12 * force.norm());
    EXPECT_LT((torque + found.torque_on_tool).norm(), 1e-12 * force.norm() * kRadius);
  }
}

/// Plates thinner than the tool is deep, from both sides, as a thick block.
TEST(Pressure, OfAThinPlateIsThatOfAThickOne) {
  for (const Yielding yielding : kBoth)
    for (const double thickness : {0.0001, 0.0007, 0.003}) {
      const mesh::TriangleMesh plate = make_flat_slab(20, 0.1, thickness);
      for (const double depth : {0.0005, 0.002, 0.004}) {
        const Vec3 above(0.001, 0.002, kRadius - depth);
        const Vec3 below(0.001, 0.002, -thickness - kRadius + depth);
        const double thick =
            press(make_flat_slab(20), ToolSolid(kBall), Pose{above}, yielding).force_on_tool.z();
        EXPECT_NEAR(press(plate, ToolSolid(kBall), Pose{above}, yielding).force_on_tool.z() / thick, 1.0,
                    0.01)
            << thickness << " " << depth;
        EXPECT_NEAR(press(plate, ToolSolid(kBall), Pose{below}, yielding).force_on_tool.z() / thick, -1.0,
                    0.01)
            << thickness << " " << depth;
      }
    }
}

TEST(Pressure, TurnsBackWhatComesAtFiveMetresASecond) {
  for (const RoundTool& tool : {kBall, kTip})
    for (const double thickness : {0.0002, 0.001, 0.005}) {
      const Misses misses = shoot(tool, thickness, 0.005, 40);
      EXPECT_EQ(misses.missed, 0) << tool.tip_radius << " " << thickness;
      EXPECT_EQ(misses.drawn, 0) << tool.tip_radius << " " << thickness;
    }
}

/// Steps of 0.8 µm to nearly its radius, while large faces are split through many levels.
TEST(Pressure, OfAFineTipHasNoJumpAsItGoesDown) {
  for (const Yielding yielding : kBoth)
    for (const int n : {5, 33}) {
      const mesh::TriangleMesh plane = make_flat_slab(n);
      PressureContact pressure = make_contact(plane, ToolSolid(kTip));
      Contacts contacts;
      std::vector<double> forces;
      for (int i = 0; i <= 1000; ++i) {
        const Pose pose{{0.0033, 0.0027, 0.001 - 8e-7 * i}};
        pressure.find_contacts(plane.vertices, pose, pose, yielding, contacts);
        forces.push_back(contacts.force_on_tool.z());
      }
      double largest = 0.0;
      for (std::size_t i = 2; i < forces.size(); ++i)
        largest = std::max(largest, std::abs(forces[i] - 2.0 * forces[i - 1] + forces[i - 2]));
      EXPECT_LT(largest / forces.back(), 0.02) << n;
    }
}

/// 50 mm/s over a plane of large faces: from tick to tick the force changes by little.
TEST(HeldPressure, IsSmoothOverEdgesAndNodes) {
  for (const int n : {5, 20, 45}) {
    const mesh::TriangleMesh plane = make_flat_slab(n);
    PressureContact pressure = make_contact(plane, ToolSolid(kBall));
    Contacts contacts;
    std::vector<double> normal;
    double side = 0.0;
    for (int i = 0; i < 800; ++i) {
      const Pose pose{{-0.02 + 5e-5 * i, 0.003 + 1e-5 * i, kRadius - 0.001}};
      pressure.find_contacts(plane.vertices, pose, pose, Yielding::no, contacts);
      normal.push_back(contacts.force_on_tool.z());
      side = std::max(side, contacts.force_on_tool.head<2>().norm());
    }
    double largest = 0.0;
    for (std::size_t i = 1; i < normal.size(); ++i)
      largest = std::max(largest, std::abs(normal[i] - normal[i - 1]));
    const double peak = *std::max_element(normal.begin(), normal.end());
    EXPECT_LT(largest / peak, 0.002) << n;
    EXPECT_LT(side / peak, 0.01) << n;
    EXPECT_LT(find_spread(normal), 0.02) << n;
  }
}

/// What may be near the tool is found for some calls ahead. A ball that slides over a swinging slab,
/// and stands while that comes up, presses the same points, to the bit, as one that looks at all of it in
/// each call.
TEST(Pressure, FacesThatAreFoundAheadAreAllThatTheToolMeets) {
  const mesh::TriangleMesh slab = make_flat_slab(100, 0.06);
  const Eigen::Index count = slab.triangles.cols();
  const auto make = [&] {
    return PressureContact(slab.triangles, slab.num_vertices(), ToolSolid(kBall),
                           {Field::Constant(count, kStiffness), Field::Constant(count, kModulus)}, true);
  };
  PressureContact ahead = make(), anew = make();
  Points x = slab.vertices;
  Pose pose{{-0.02, 0.001, kRadius + 0.0003}};
  const auto same = [](const std::vector<Contact>& a, const std::vector<Contact>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Contact& p, const Contact& q) {
      return p.vertex == q.vertex && p.weight == q.weight && p.force == q.force && p.stiffness == q.stiffness;
    });
  };
  Contacts found, expected;
  std::size_t most = 0;
  for (int call = 1; call <= 300; ++call) {
    Points next = x;
    const int rising = std::max(0, call - 150);         // then the ball stands still and the slab comes up
    const double swing = call % 40 < 20 ? 2e-6 : 6e-5;  // [m] a call, slow and fast by turns
    for (Eigen::Index v = 0; v < next.cols(); ++v)
      next(2, v) = slab.vertices(2, v) + 4e-5 * rising +
                   10.0 * swing * std::sin(0.1 * call + 200.0 * slab.vertices(0, v));
    const Pose to{{0.02 * std::sin(0.004 * (call - rising) - 1.5), 0.001, kRadius - 0.0008}};
    const double motion = (next - x).cwiseAbs().maxCoeff();
    anew.forget();
    for (PressureContact* pressure : {&ahead, &anew}) pressure->advance(x, next, motion);
    ahead.find_contacts(next, pose, to, Yielding::yes, found);
    anew.find_contacts(next, pose, to, Yielding::yes, expected);
    ASSERT_TRUE(same(found.contacts, expected.contacts) && same(found.near, expected.near)) << call;
    most = std::max(most, found.contacts.size() + found.near.size());
    x = next;
    pose = to;
  }
  EXPECT_GT(most, 20U);
}

/// A ball measures eight faces at a time, any other tool one: a capsule of next to no length presses the same
/// points, at rest, on a short way and on a long one.
TEST(Pressure, OfABallIsThatOfACapsuleOfNoLength) {
  constexpr double kSame = 1e-7;  // of the largest: lengths of 1e-13 m in depths of 1e-5 m and more
  Rng rng(5);
  mesh::TriangleMesh slab = make_flat_slab(60, 0.05);
  const double top = slab.vertices.row(2).maxCoeff();
  for (Eigen::Index v = 0; v < slab.vertices.cols(); ++v)
    if (slab.vertices(2, v) == top) slab.vertices(2, v) += rng.uniform(-2e-4, 2e-4);
  const Eigen::Index count = slab.triangles.cols();
  const auto make = [&](double length) {
    return PressureContact(slab.triangles, slab.num_vertices(),
                           ToolSolid(RoundTool{kRadius, length, kRadius, false}),
                           {Field::Constant(count, kStiffness), Field::Constant(count, kModulus)}, true);
  };
  std::size_t most = 0, most_near = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double way = std::array{0.0, 2e-5, 1e-3, 0.6 * kRadius, 1.5 * kRadius}[trial % 5];
    const double angle = rng.uniform(0.0, 6.28);
    const Pose to{{rng.uniform(-0.01, 0.01), rng.uniform(-0.01, 0.01), kRadius - rng.uniform(-3e-4, 2e-3)}};
    const Pose from{to.position + way * Vec3(std::cos(angle), std::sin(angle), 0.1)};
    Contacts found[2];
    Patch patch[2];
    for (int k = 0; k < 2; ++k) {
      PressureContact pressure = make(k == 0 ? 0.0 : 1e-13);
      pressure.find_contacts(slab.vertices, from, to, Yielding::yes, found[k]);
      patch[k] = pressure.find_patch();
    }
    EXPECT_NEAR(patch[0].radius, patch[1].radius, kSame * kRadius) << trial;
    EXPECT_NEAR(patch[0].modulus, patch[1].modulus, kSame * kModulus) << trial;
    const double largest = kSame * std::max(1e-3, found[1].force_on_tool.norm());
    for (const auto list : {&Contacts::contacts, &Contacts::near}) {
      ASSERT_EQ((found[0].*list).size(), (found[1].*list).size()) << trial;
      for (std::size_t i = 0; i < (found[0].*list).size(); ++i) {
        const Contact &ball = (found[0].*list)[i], &capsule = (found[1].*list)[i];
        ASSERT_EQ(ball.vertex, capsule.vertex) << trial;
        EXPECT_LT((ball.force - capsule.force).norm(), largest) << trial;
        EXPECT_NEAR(ball.stiffness, capsule.stiffness, kSame * capsule.stiffness) << trial;
      }
    }
    most = std::max(most, found[0].contacts.size());
    most_near = std::max(most_near, found[0].near.size());
  }
  EXPECT_GT(most, 50U);
  EXPECT_GT(most_near, 20U);
}

}  // namespace
}  // namespace argil::contact
