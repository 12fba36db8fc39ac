// What a hand feels: force law of a pressed sphere, action and reaction, continuity in a press and a slide.
// (paper, eqs. 7 and 8; conventions in src/contact/README.md)

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes.h"

namespace argil::contact {
namespace {

using test::kK;
using test::kR;
using test::make_flat_slab;
using test::make_slab;
using test::Scene;

TEST(Press, ToolVerticesFeelTheSumOfTheirDepthsBelowAPlane) {
  // Over a flat face each tool vertex presses with k times its own depth; the body's vertices add k times
  // theirs in the tool, along the tool's normals. Reference: depths straight from the geometry, without the
  // detector.
  const mesh::TriangleMesh tool = make_sphere_tool(kR, 3);
  Scene scene(make_flat_slab(2), tool, {0.011, 0.007, kR + 1e-4});  // no body vertex near
  scene.move(Vec3(0.011, 0.007, kR - 0.0015));
  scene.move(Vec3(0.011, 0.007, kR - 0.0015));  // at rest: mean over the tick = present depth
  double sum = 0.0;
  for (int v = 0; v < tool.num_vertices(); ++v) sum += std::max(0.0, -(tool.vertices(2, v) + kR - 0.0015));
  ASSERT_GT(sum, 0.0);
  EXPECT_NEAR(scene.force().z(), kK * sum, 1e-12 * kK * sum);
  EXPECT_NEAR(scene.force().head<2>().norm(), 0.0, 1e-12 * kK * sum);
  double stiffness = 0.0;
  for (const Contact& c : scene.contacts.contacts) stiffness += c.stiffness;
  EXPECT_NEAR(stiffness, kK * static_cast<double>(scene.contacts.contacts.size()),
              1e-9);  // whole tick inside
}

TEST(Press, ForceAndTorqueAreEqualAndOppositeAboutAnyPoint) {
  Scene scene(make_flat_slab(), make_sphere_tool(kR, 2), {0.0013, 0.0007, kR + 1e-4});
  Pose next = scene.pose;
  for (int i = 0; i < 20; ++i) {
    next.position += Vec3(1e-4, 0.5e-4, i < 10 ? -1.5e-4 : 0.0);
    next.orientation =
        (next.orientation * Quat(Eigen::AngleAxisd(0.03, Vec3(1, 2, 3).normalized()))).normalized();
    scene.lead(next);
    for (const Vec3& about : {Vec3(0, 0, 0), Vec3(1, -2, 3)}) {
      const auto [force, moment] = test::sum_body_forces(scene.contacts, scene.body.vertices, about);
      const Vec3 tool_moment = scene.contacts.torque_on_tool + (next.position - about).cross(scene.force());
      EXPECT_NEAR((force + scene.force()).norm(), 0.0, 1e-12);  // rounding of forces up to 10 N
      EXPECT_NEAR((moment + tool_moment).norm(), 0.0, 1e-11);   // and of arms up to 4 m
    }
  }
  EXPECT_GT(scene.force().z(), 0.1);
}

TEST(Press, ForcePointsAlongTheNormalAndGrowsWithoutJumps) {
  Scene scene(make_flat_slab(), make_sphere_tool(kR, 3), {0.0013, 0.0007, kR + 1e-4});
  double last = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double depth = -1e-4 + 1e-5 * (i + 1);
    scene.move(Vec3(0.0013, 0.0007, kR - depth));
    const Vec3 f = scene.force();
    EXPECT_GE(f.z(), last) << i;
    // The steepest the force can grow: every vertex below the plane by k times the step.
    EXPECT_LE(f.z() - last, kK * 1e-5 * (static_cast<double>(scene.contacts.contacts.size()) + 1.0)) << i;
    if (depth > 5e-4) {
      EXPECT_LT(f.head<2>().norm(), 0.02 * f.z()) << i;  // facets of both meshes
    }
    last = f.z();
  }
  EXPECT_GT(last, 1.0);
}

TEST(Press, DisplacedVolumeLawIsReachedByFineTools) {
  // k Σ depth over vertices of a uniform tool tends to k/(area per vertex) × volume of the cap below the
  // plane, π d² (R − d/3), counted along the plane: vertices per area of the plane's projection of the
  // sphere. A depth weighted by the sphere's own area is 2πR∫₀^d (d−h) dh = πRd².
  const double d = 0.002;
  double last_error = 1.0;
  for (const int level : {3, 4, 5}) {
    const mesh::TriangleMesh tool = make_sphere_tool(kR, level);
    Scene scene(make_flat_slab(2), tool, {0.011, 0.007, kR + 1e-4});
    scene.move(Vec3(0.011, 0.007, kR - d));
    scene.move(Vec3(0.011, 0.007, kR - d));
    const double area_per_vertex = 4.0 * std::numbers::pi * kR * kR / tool.num_vertices();
    const double smooth = kK * std::numbers::pi * kR * d * d / area_per_vertex;
    const double error = std::abs(scene.force().z() / smooth - 1.0);
    EXPECT_LT(error, 0.05) << level;  // vertices of a subdivided icosahedron are uneven by some percent
    last_error = error;
  }
  EXPECT_LT(last_error, 0.05);
}

TEST(Slide, OverFlatAndCurvedGroundTheForceHasNoJumps) {
  const auto hill = [](double x, double y) { return 0.006 * std::exp(-(x * x + y * y) / (2 * 0.02 * 0.02)); };
  for (const bool curved : {false, true}) {
    const mesh::TriangleMesh body = curved ? make_slab(20, 0.1, 0.02, hill) : make_flat_slab();
    const auto ground = [&](double x, double y) { return curved ? hill(x, y) : 0.0; };
    const double y = 0.0017;
    Scene scene(body, make_sphere_tool(kR, 3), {-0.03, y, ground(-0.03, y) + kR + 1e-4});
    const int steps = 600;
    const double step = 0.06 / steps;  // 0.1 mm a tick: 0.1 m/s
    for (int i = 0; i <= 10; ++i) scene.move(Vec3(-0.03, y, ground(-0.03, y) + kR - 1e-4 * i));
    Vec3 last = Vec3::Zero();
    double largest_jump = 0.0;
    double largest = 0.0;
    double least = 1e300;
    for (int i = 1; i <= steps; ++i) {
      const double x = -0.03 + step * i;
      scene.move(Vec3(x, y, ground(x, y) + kR - 0.001));
      if (i > 2) largest_jump = std::max(largest_jump, (scene.force() - last).norm());
      if (i > 2) largest = std::max(largest, scene.force().norm());
      if (i > 2) least = std::min(least, scene.force().norm());
      last = scene.force();
    }
    std::printf("slide on %s ground: force %.3f to %.3f N, largest change in 0.1 mm %.4f N\n",
                curved ? "curved" : "flat", least, largest, largest_jump);
    // Below the hand's just noticeable difference of about 7 %; the flat case has no reason to change at all
    // but for body vertices passing under the tool's facets.
    EXPECT_LT(largest_jump, (curved ? 0.05 : 0.03) * largest);
    EXPECT_GT(least, curved ? 0.3 * largest : 0.85 * largest);
  }
}

/// Largest change of the force in one step, over its mean, while a sphere slides over a facetted sphere in
/// steps of `step` at a depth of 1 mm between the round shapes; after `smaller` such steps.
double measure_largest_change(const ContactParams& params, double step) {
  constexpr double kBodyRadius = 0.03;
  const mesh::TriangleMesh body = make_sphere_tool(kBodyRadius, 3);
  const auto place = [](double along, double depth) {
    const double angle = along / kBodyRadius;  // in a plane askew to the mesh
    const Vec3 a = Vec3(0.3, -0.2, 0.9).normalized();
    const Vec3 b = a.cross(Vec3(0.5, 0.7, 0.1)).normalized();
    return Vec3((kBodyRadius + kR - depth) * (std::cos(angle) * a + std::sin(angle) * b));
  };
  Scene scene(body, make_sphere_tool(kR, 2), place(0.0, -1e-4));
  scene.detector = ContactDetector(body.triangles, body.num_vertices(), make_sphere_tool(kR, 2), params);
  for (int i = 0; i <= 10; ++i) scene.move(place(0.0, 1e-4 * i));
  scene.move(place(0.0, 1e-3));
  double change = 0.0;
  double sum = 0.0;
  Vec3 last = scene.force();
  const int steps = static_cast<int>(0.02 / step);
  for (int i = 1; i <= steps; ++i) {
    scene.move(place(step * i, 1e-3));
    change = std::max(change, (scene.force() - last).norm());
    last = scene.force();
    sum += last.norm();
  }
  return change / (sum / steps);
}

TEST(Slide, OverFacetsTheForceIsContinuousWhenBlended) {
  // A continuous force changes by ever less in ever smaller steps; one that jumps where a vertex passes from
  // face to face does not.
  const ContactParams blended{kK, kK};
  ContactParams nearest = blended;
  nearest.face_blend = 0.0;
  ContactParams discrete = blended;
  discrete.penalty = PenaltyKind::discrete;
  for (const auto& [name, params] :
       {std::pair{"blended", blended}, std::pair{"nearest face", nearest}, std::pair{"discrete", discrete}}) {
    std::printf("%-12s largest change of the force in a step of", name);
    for (const double step : {1e-4, 3e-5, 1e-5})
      std::printf(" %g mm: %.4f,", 1e3 * step, measure_largest_change(params, step));
    std::printf(" of the mean force\n");
  }
  EXPECT_LT(measure_largest_change(blended, 1e-5), 0.25 * measure_largest_change(blended, 1e-4));
  EXPECT_GT(measure_largest_change(nearest, 1e-5), 0.5 * measure_largest_change(nearest, 1e-4));
}

TEST(Press, EdgesThatPassedEachOtherBeyondAnEndPressFromWhereTheyMeet) {
  // The body's upper edge goes in the plane x = 2 − 2t from (y, z) = (−½ − t, A − 3t/2) to (1, t), A = 3/16,
  // and the tool's lower edge rests along x from −1 to 1. At y = 0 the former is (t − ¼)(t − ¾)/(3/2 + t)
  // high: it passes the tool beyond its end, and comes up into it at t = ¾. Both ends stay outside.
  const auto tetrahedron = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    mesh::TriangleMesh mesh;
    mesh.vertices.resize(3, 4);
    mesh.vertices << a, b, c, d;
    const bool is_right_handed = (b - a).cross(c - a).dot(d - a) > 0.0;
    mesh.triangles.resize(3, 4);
    mesh.triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
    if (!is_right_handed) mesh.triangles.row(1).swap(mesh.triangles.row(2));
    return mesh;
  };
  const mesh::TriangleMesh tool = tetrahedron(Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(0, -3, 2), Vec3(0, 0.3, 2));
  const auto body_at = [&](double t) {
    const double x = 2.0 - 2.0 * t;
    return tetrahedron(Vec3(x, -0.5 - t, 0.1875 - 1.5 * t), Vec3(x, 1, t), Vec3(x - 0.3, 0, -2),
                       Vec3(x + 0.3, 0, -2));
  };
  ContactDetector detector(body_at(0.0).triangles, 4, tool, {kK, kK});
  Contacts contacts;
  detector.find_contacts(body_at(0.0).vertices, body_at(1.0).vertices, {}, {}, contacts);
  // Depth along the common normal (0, A − 5t/2, 3/2 + t) of both edges, out of the body.
  Vec3 sum = Vec3::Zero();
  constexpr int kPieces = 1000;
  for (int i = 0; i < kPieces; ++i) {
    const double t = 0.75 + 0.25 * (i + 0.5) / kPieces;
    const Vec3 n(0.0, 0.1875 - 2.5 * t, 1.5 + t);
    sum += 0.25 / kPieces * (t - 0.25) * (t - 0.75) / n.squaredNorm() * n;
  }
  ASSERT_EQ(contacts.contacts.size(), 1U);
  // Midpoints: the square of a piece over 24, times the second derivative, which is near 1.
  EXPECT_NEAR((contacts.force_on_tool - kK * sum).norm(), 0.0, 1e-7 * kK * sum.norm());
}

/// One vertex down, at the hand's point.
mesh::TriangleMesh make_spike() {
  mesh::TriangleMesh spike;
  spike.vertices.resize(3, 4);
  spike.vertices << 0, 0.004, -0.002, -0.002, 0, 0, 0.0035, -0.0035, 0, 0.02, 0.02, 0.02;
  spike.triangles.resize(3, 4);
  spike.triangles << 0, 0, 0, 1, 2, 3, 1, 2, 1, 2, 3, 3;
  return spike;
}

/// The same surface, its vertices and triangles counted from the other end.
mesh::TriangleMesh renumber(const mesh::TriangleMesh& mesh) {
  mesh::TriangleMesh other;
  other.vertices = mesh.vertices.rowwise().reverse();
  other.triangles = (mesh.num_vertices() - 1) - mesh.triangles.rowwise().reverse().array();
  return other;
}

TEST(Discrete, CountsTheDepthAtTheEndOfTheTickAndMissesWhatWentThrough) {
  // One tool vertex over a flat face, by hand: from 1 mm above to 1 mm below, a quarter mm mean depth, 1 mm
  // at the end; at rest both count 1 mm.
  const mesh::TriangleMesh spike = make_spike();
  for (const bool is_discrete : {false, true}) {
    ContactParams params{kK, kK};
    params.penalty = is_discrete ? PenaltyKind::discrete : PenaltyKind::continuous;
    Scene scene(make_flat_slab(2), spike, {0.011, 0.007, 0.001});
    scene.detector = ContactDetector(scene.body.triangles, scene.body.num_vertices(), spike, params);
    scene.move(Vec3(0.011, 0.007, -0.001));
    EXPECT_NEAR(scene.force().z(), kK * (is_discrete ? 1e-3 : 0.25e-3), 1e-14);
    scene.move(scene.pose.position);
    EXPECT_NEAR(scene.force().z(), kK * 1e-3, 1e-14);
    // Up, and then down through the whole slab of 20 mm and out below in one tick.
    scene.move(Vec3(0.011, 0.007, 0.001));
    scene.move(Vec3(0.011, 0.007, -0.2));
    EXPECT_EQ(scene.force().norm() > 0.1, !is_discrete);
  }
}

TEST(Discrete, AboveAGrooveOrAPitTheForceIsTheDistanceAndPrefersNoFace) {
  // The place nearest to a point below the bottom is the bottom itself: the force is k times the distance,
  // straight up, however the faces that meet there are numbered and split.
  ContactParams params{kK, 0.0};
  params.penalty = PenaltyKind::discrete;
  const auto groove = [](double x, double) { return 0.5 * std::abs(x); };
  const auto pit = [](double x, double y) { return 0.5 * std::abs(x) + 0.3 * std::abs(y); };
  for (const bool is_pit : {false, true}) {
    const mesh::TriangleMesh body = is_pit ? make_slab(4, 0.04, 0.02, pit) : make_slab(4, 0.04, 0.02, groove);
    const Vec3 bottom(0.0, is_pit ? 0.0 : 0.0037, 0.0);
    for (const mesh::TriangleMesh& numbered : {body, renumber(body)}) {
      Scene scene(numbered, make_spike(), bottom + Vec3(0, 0, 0.001));
      scene.detector = ContactDetector(numbered.triangles, numbered.num_vertices(), make_spike(), params);
      scene.move(bottom - Vec3(0, 0, 0.001));
      int num_of_tip = 0;
      for (const Contact& c : scene.contacts.contacts) {
        if (c.vertex[1] < 0) continue;  // the pit's own vertex, in the tool
        EXPECT_NEAR((c.force - Vec3(0, 0, -kK * 1e-3)).norm(), 0.0, 1e-15) << is_pit;
        EXPECT_NEAR(c.end_force, kK * 1e-3, 1e-15);
        ++num_of_tip;
      }
      EXPECT_EQ(num_of_tip, 1) << is_pit;
    }
  }
}

TEST(Press, TheForceIsTheSameHoweverTheBodyIsNumbered) {
  // Over hills and hollows, where a vertex often lies below the edge of two faces, and edges cross edges.
  const auto waves = [](double x, double y) { return 0.004 * std::sin(180.0 * x) * std::cos(150.0 * y); };
  const mesh::TriangleMesh body = make_slab(20, 0.1, 0.02, waves);
  ContactParams params{kK, kK};
  params.damping = 0.5;
  params.friction = 0.3;
  const mesh::TriangleMesh tool = make_sphere_tool(kR, 2);
  const Vec3 start(-0.02, 0.0017, 0.02);
  for (const PenaltyKind penalty : {PenaltyKind::discrete, PenaltyKind::continuous}) {
    params.penalty = penalty;
    Scene here(body, tool, start);
    Scene there(renumber(body), tool, start);
    for (Scene* scene : {&here, &there})
      scene->detector = ContactDetector(scene->body.triangles, scene->body.num_vertices(), tool, params);
    double largest = 0.0;
    for (int i = 0; i <= 300; ++i) {
      const Vec3 place(-0.02 + 1.3e-4 * i, 0.0017 + 2e-5 * i, std::max(kR - 1e-4, 0.02 - 1e-3 * i));
      for (Scene* scene : {&here, &there}) {
        scene->detector.find_contacts(scene->body.vertices, scene->body.vertices, scene->pose, Pose{place},
                                      scene->contacts, {}, 1e-3);
        scene->pose.position = place;
      }
      const Vec3 difference =
          here.force() + here.contacts.resistance_on_tool - there.force() - there.contacts.resistance_on_tool;
      largest = std::max(largest, here.force().norm());
      EXPECT_NEAR(difference.norm(), 0.0, 1e-12 * kK) << i;
    }
    EXPECT_GT(largest, 0.5);
  }
}

}  // namespace
}  // namespace argil::contact
