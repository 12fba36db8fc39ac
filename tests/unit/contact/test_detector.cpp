// What the detector finds: fast motions and edges, nothing after the tool has left, the same bits again, and
// nothing from the heap.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes.h"
#include "support/heap_count.h"

namespace argil::contact {
namespace {

using test::kK;
using test::kR;
using test::make_flat_slab;
using test::make_slab;
using test::Scene;

TEST(LiftOff, LeavesNothingBehind) {
  Scene scene(make_flat_slab(), make_sphere_tool(kR, 2), {0.001, 0.002, kR + 1e-4});
  for (int i = 0; i < 20; ++i) scene.move(scene.pose.position + Vec3(2e-4, 0, i < 15 ? -1e-4 : 0.0));
  EXPECT_GT(scene.force().z(), 0.0);
  for (int i = 0; i < 15; ++i) scene.move(scene.pose.position + Vec3(0, 0, 1e-4));
  scene.move(scene.pose.position + Vec3(0, 0, 1e-4));
  EXPECT_TRUE(scene.contacts.contacts.empty());
  EXPECT_TRUE(scene.contacts.touched_triangle.empty());
  EXPECT_EQ(scene.force(), Vec3(0, 0, 0));
  const ContactState state = scene.detector.state();
  EXPECT_TRUE(state.tool_vertex.empty() && state.body_vertex.empty());
}

TEST(LiftOff, OutOverTheRimAndThroughAThinPlateLeaveNothingBehind) {
  // Sideways over the edge of the slab: no plane of the top is crossed on the way out.
  Scene rim(make_flat_slab(), make_sphere_tool(0.003, 2), {0.045, 0.001, 0.0031});
  for (int i = 0; i < 10; ++i) rim.move(rim.pose.position + Vec3(0, 0, -2e-4));
  EXPECT_GT(rim.force().z(), 0.0);
  for (int i = 0; i < 20; ++i) rim.move(rim.pose.position + Vec3(1e-3, 0, 0));
  EXPECT_TRUE(rim.contacts.contacts.empty());

  // Down through a plate of 2 mm and on: the force must end when the tool is through.
  Scene plate(make_flat_slab(20, 0.1, 0.002), make_sphere_tool(0.003, 2), {0.001, 0.002, 0.0031});
  double largest = 0.0;
  for (int i = 0; i < 120; ++i) {
    plate.move(plate.pose.position + Vec3(0, 0, -1e-4));
    largest = std::max(largest, plate.force().norm());
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_TRUE(plate.contacts.contacts.empty());
  plate.move(plate.pose.position + Vec3(0, 0, -0.05));
  EXPECT_EQ(plate.force(), Vec3(0, 0, 0));
}

TEST(LiftOff, SidewaysAVertexPressesUntilItIsOut) {
  // A pin 0.5 mm deep goes out over the rim, 1 mm away, in one interval: k d for that share of it, where it
  // keeps its depth. The rim is all that counts where it also rises, whether it comes above the plane of the
  // face on the way or not.
  constexpr double kDepth = 5e-4;
  constexpr double kToRim = 1e-3;
  mesh::TriangleMesh pin;
  pin.vertices.resize(3, 4);
  pin.vertices << 0, 2e-4, -2e-4, -2e-4,  //
      0, 0, 2e-4, -2e-4,                  //
      0, 0.01, 0.01, 0.01;
  pin.triangles.resize(3, 4);
  pin.triangles << 0, 0, 0, 1,  //
      2, 3, 1, 2,               //
      1, 2, 3, 3;
  ASSERT_NO_THROW(require_closed_surface(pin, "pin"));
  for (const double way : {1.0001e-3, 1.05e-3, 2e-3, 7e-3, 0.1})
    for (const double rise : {0.0, 0.999, 1.001, 1.5}) {  // of the depth
      const double to_rim = kToRim / way;
      if (rise * to_rim > 1.0) continue;  // out through the face
      Scene scene(make_flat_slab(), pin, {0.05 - kToRim, 0.003, 1e-4});
      scene.move(scene.pose.position + Vec3(0, 0, -1e-4 - kDepth));
      scene.move(scene.pose.position + Vec3(way, 0, rise * kDepth));
      double share = 0.0;  // of the interval, times k d
      for (const Contact& c : scene.contacts.contacts)
        if (c.vertex[2] >= 0) share -= c.force.z() / (kK * kDepth);
      const double expected = to_rim - 0.5 * rise * to_rim * to_rim;
      EXPECT_GE(share, expected - 1e-9) << way << ' ' << rise;
      EXPECT_LE(share, expected + 1.0 / 4096.0) << way << ' ' << rise;
      scene.move(scene.pose.position);
      EXPECT_TRUE(scene.contacts.contacts.empty());
    }
}

TEST(LiftOff, FromASharpRidgeNoVertexStaysBehindAFace) {
  // A ridge with an edge of 30°: beside it, a point in front of one flank lies behind the other's plane.
  const auto roof = [](double x, double) { return 0.02 - 3.7 * std::abs(x); };
  Scene scene(make_slab(20, 0.02, 0.05, roof), make_sphere_tool(0.004, 3), {0.0003, 0.0001, 0.0242});
  for (int i = 0; i < 12; ++i) scene.move(scene.pose.position + Vec3(0, 0, -1e-4));
  EXPECT_GT(scene.force().z(), 0.0);
  for (int i = 0; i < 30; ++i) scene.move(scene.pose.position + Vec3(3e-4, 0, 2e-4));
  EXPECT_TRUE(scene.contacts.contacts.empty());
}

TEST(Ridge, EdgesCarryWhatNoVertexReaches) {
  // Two wedges crossing at right angles: only their edges meet. The force must be there, point up, be k_ee
  // times the depth, and not change while the tool's edge slides from one segment of the ridge to the next.
  const auto roof = [](double x, double) { return -1.0 * std::abs(x); };
  mesh::TriangleMesh tool;
  tool.vertices.resize(3, 6);
  tool.vertices << -0.03, 0.03, -0.03, 0.03, -0.03, 0.03,  //
      0, 0, 0.01, 0.01, -0.01, -0.01,                      //
      0, 0, 0.01, 0.01, 0.01, 0.01;
  tool.triangles.resize(3, 8);
  tool.triangles << 0, 0, 0, 0, 2, 2, 0, 1,  //
      2, 3, 5, 1, 4, 5, 4, 3,                //
      3, 1, 4, 5, 5, 3, 2, 5;
  ASSERT_NO_THROW(require_closed_surface(tool, "wedge"));
  Scene scene(make_slab(20, 0.1, 0.1, roof), tool, {0.0, 0.0011, 1e-4});
  for (int i = 0; i < 6; ++i) scene.move(scene.pose.position + Vec3(0, 0, -1e-4));
  scene.move(scene.pose.position);
  EXPECT_NEAR(scene.force().z(), kK * 5e-4, 1e-9);
  EXPECT_NEAR(scene.force().head<2>().norm(), 0.0, 1e-9);
  double least = 1e300;
  double largest = 0.0;
  for (int i = 0; i < 300; ++i) {  // 15 mm along the ridge: three segments of 5 mm
    scene.move(scene.pose.position + Vec3(0, 5e-5, 0));
    least = std::min(least, scene.force().z());
    largest = std::max(largest, scene.force().z());
  }
  EXPECT_NEAR(least, kK * 5e-4, 0.35 * kK * 5e-4);  // ridge vertices press along the wedge's flanks, at 45°
  EXPECT_NEAR(largest, kK * 5e-4, 0.05 * kK * 5e-4);
  for (int i = 0; i < 8; ++i) scene.move(scene.pose.position + Vec3(0, 0, 1e-4));
  EXPECT_TRUE(scene.contacts.contacts.empty());
}

TEST(Fast, APokeAndALeapAreNotMissed) {
  Scene poke(make_flat_slab(), make_sphere_tool(kR, 2), {0.001, 0.002, kR + 0.0005});
  poke.move(poke.pose.position + Vec3(0, 0, -0.001));  // 1 m/s
  EXPECT_GT(poke.force().z(), 0.0);
  // 40 mm in one tick, through a plate of 2 mm and out on the other side: felt, then forgotten.
  Scene leap(make_flat_slab(20, 0.1, 0.002), make_sphere_tool(kR, 2), {0.001, 0.002, 0.02});
  leap.move(Vec3(0.001, 0.002, -0.02));
  EXPECT_GT(leap.force().z(), 0.0);
  leap.move(Vec3(0.001, 0.002, -0.021));
  EXPECT_TRUE(leap.contacts.contacts.empty());
  // 10 mm into the slab: all of the tool's lower vertices are seen.
  Scene deep(make_flat_slab(20, 0.1, 0.05), make_sphere_tool(kR, 2), {0.001, 0.002, kR + 0.001});
  deep.move(Vec3(0.001, 0.002, kR - 0.009));
  const ContactState state = deep.detector.state();
  int below = 0;
  const mesh::TriangleMesh tool = make_sphere_tool(kR, 2);
  for (int v = 0; v < tool.num_vertices(); ++v) below += tool.vertices(2, v) + kR - 0.009 < 0.0 ? 1 : 0;
  EXPECT_EQ(static_cast<int>(state.tool_vertex.size()), below);
}

TEST(Overlap, IsSeenForVerticesEdgesAndWholeInclusion) {
  const Scene scene(make_flat_slab(4), make_sphere_tool(kR, 1), {0, 0, 0});
  const auto overlaps = [&](double x, double y, double z) {
    return scene.detector.overlaps(scene.body.vertices, Pose{Vec3(x, y, z), Quat::Identity()});
  };
  EXPECT_FALSE(overlaps(0.003, 0.002, 0.0085));
  EXPECT_TRUE(overlaps(0.003, 0.002, 0.007));
  EXPECT_TRUE(overlaps(0.003, 0.002, -0.01));  // wholly inside the slab, 20 mm thick
  EXPECT_FALSE(overlaps(0.003, 0.002, -0.029));
  EXPECT_FALSE(overlaps(0.2, 0.0, 0.0));
  EXPECT_TRUE(overlaps(0.05, 0.05, 0.003));  // over a corner: edges cross
  const Scene around(make_flat_slab(2, 0.004, 0.004), make_sphere_tool(kR, 2), {0, 0, 0});
  EXPECT_TRUE(around.detector.overlaps(around.body.vertices, Pose{}));  // body wholly inside the tool
}

TEST(Overlap, IsSeenForEachPartOfASurface) {
  constexpr double kApart = 0.05;
  const mesh::TriangleMesh ball = make_sphere_tool(0.003, 1);
  const mesh::TriangleMesh slab = make_flat_slab(4, 0.02, 0.02);
  const Vec3 inside(0.001, 0.002, -0.01);  // of the slab
  for (const double second : {-kApart, kApart}) {
    const Vec3 by(second, 0, 0);
    const Scene two_tools(slab, test::make_pair(ball, ball, by), Vec3::Zero());
    EXPECT_TRUE(two_tools.detector.overlaps(slab.vertices, Pose{inside, Quat::Identity()}));
    EXPECT_TRUE(two_tools.detector.overlaps(slab.vertices, Pose{inside - by, Quat::Identity()}));
    EXPECT_FALSE(two_tools.detector.overlaps(slab.vertices, Pose{inside - 2.0 * by, Quat::Identity()}));
    const Scene two_slabs(test::make_pair(slab, slab, by), ball, Vec3::Zero());
    EXPECT_TRUE(two_slabs.detector.overlaps(two_slabs.body.vertices, Pose{inside, Quat::Identity()}));
    EXPECT_TRUE(two_slabs.detector.overlaps(two_slabs.body.vertices, Pose{inside + by, Quat::Identity()}));
    EXPECT_FALSE(
        two_slabs.detector.overlaps(two_slabs.body.vertices, Pose{inside + 2.0 * by, Quat::Identity()}));
  }
}

TEST(Determinism, SameBitsAgainAndFromACheckpoint) {
  const auto place = [](int i) { return Vec3(-0.02 + 2e-4 * i, 0.001, kR + 1e-4 - 2e-5 * std::min(i, 60)); };
  Scene one(make_flat_slab(), make_sphere_tool(kR, 2), place(0));
  Scene two(make_flat_slab(), make_sphere_tool(kR, 2), place(0));
  for (int i = 1; i < 80; ++i) {
    one.move(place(i));
    two.move(place(i));
    ASSERT_EQ(one.force(), two.force()) << i;
  }
  Scene resumed(make_flat_slab(), make_sphere_tool(kR, 2), one.pose.position);
  resumed.detector.restore(one.detector.state());
  for (int i = 80; i < 160; ++i) {
    one.move(place(i));
    resumed.move(place(i));
    ASSERT_EQ(one.force(), resumed.force()) << i;
    ASSERT_EQ(one.contacts.torque_on_tool, resumed.contacts.torque_on_tool) << i;
    ASSERT_EQ(one.contacts.touched_area, resumed.contacts.touched_area) << i;
  }
  EXPECT_GT(one.force().norm(), 0.0);
}

TEST(Determinism, SameBitsOnAnyNumberOfThreads) {
  const auto bumpy = [](double x, double y) { return 3e-4 * std::sin(2000.0 * x) * std::cos(1700.0 * y); };
  const auto place = [](int i) { return Vec3(-4e-3 + 1e-4 * i, 1e-3, kR - 2e-5 * std::min(i, 60)); };
  std::vector<Scene> scenes;
  for (const int threads : {1, 2, 3, 7}) {
    scenes.emplace_back(make_slab(60, 0.06, 0.02, bumpy), make_sphere_tool(kR, 3), place(0));
    scenes.back().detector.share(threads);
  }
  std::size_t most = 0;
  for (int i = 1; i < 80; ++i) {
    for (Scene& scene : scenes) scene.move(place(i));
    const Contacts& one = scenes.front().contacts;
    for (const Scene& scene : scenes) {
      const Contacts& other = scene.contacts;
      ASSERT_EQ(one.contacts.size(), other.contacts.size()) << i;
      for (std::size_t k = 0; k < one.contacts.size(); ++k) {
        ASSERT_EQ(one.contacts[k].vertex, other.contacts[k].vertex) << i;
        ASSERT_EQ(one.contacts[k].force, other.contacts[k].force) << i;
      }
      ASSERT_EQ(one.torque_on_tool, other.torque_on_tool) << i;
      ASSERT_EQ(one.touched_triangle, other.touched_triangle) << i;
      ASSERT_EQ(one.touched_area, other.touched_area) << i;
      ASSERT_EQ(scenes.front().detector.state().body_face, scene.detector.state().body_face) << i;
    }
    most = std::max(most, one.contacts.size());
  }
  EXPECT_GT(most, 32U);  // enough for all to have some
}

#ifdef ARGIL_COUNTS_HEAP
void expect_no_heap_after_warm_up(int threads) {
  Scene scene(make_flat_slab(), make_sphere_tool(kR, 2), {0.0, 0.001, kR + 1e-4});
  ContactParams params{kK, kK};
  params.friction = 0.5;  // keeps springs besides
  scene.detector =
      ContactDetector(scene.body.triangles, scene.body.num_vertices(), make_sphere_tool(kR, 2), params);
  scene.detector.share(threads);
  const auto lap = [&] {
    for (int i = 0; i < 40; ++i)
      scene.move(Vec3(0.001 * std::sin(0.3 * i), 0.001, kR + 1e-4 - 1e-4 * std::min(i, 40 - i)));
  };
  lap();
  lap();
  const std::size_t before = argil::test::count_allocations();
  lap();
  EXPECT_EQ(argil::test::count_allocations() - before, 0U) << threads << " threads";
}

TEST(Cost, NoHeapAfterWarmUp) {
  expect_no_heap_after_warm_up(1);
  expect_no_heap_after_warm_up(2);
}
#endif

TEST(Motion, AMinimumSeparationOfDetectionLeavesTheForceAsItIs) {
  // More pairs are looked at; what does not penetrate exerts nothing.
  const mesh::TriangleMesh tool = make_sphere_tool(kR, 2);
  Scene plain(make_flat_slab(), tool, {0.0013, 0.0007, kR + 1e-4});
  Scene wide(make_flat_slab(), tool, {0.0013, 0.0007, kR + 1e-4});
  ContactParams params{kK, kK};
  params.minimum_separation = 5e-4;
  wide.detector = ContactDetector(wide.body.triangles, wide.body.num_vertices(), tool, params);
  plain.detector = ContactDetector(plain.body.triangles, plain.body.num_vertices(), tool, {kK, kK});
  double largest = 0.0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 next = plain.pose.position + Vec3(2e-5, 1e-5, i < 30 ? -5e-5 : 5e-5);
    plain.move(next);
    wide.move(next);
    EXPECT_LT((plain.force() - wide.force()).norm(), 1e-12) << i;
    largest = std::max(largest, plain.force().norm());
  }
  EXPECT_GT(largest, 0.1);
}

TEST(Motion, BodyPressingAgainstAToolAtRestFeelsTheSame) {
  // Only the relative motion counts: the slab rises against the tool instead of the tool coming down.
  const mesh::TriangleMesh tool = make_sphere_tool(kR, 2);
  Scene down(make_flat_slab(), tool, {0.0013, 0.0007, kR + 1e-4});
  Scene up(make_flat_slab(), tool, {0.0013, 0.0007, kR + 1e-4});
  Points x = up.body.vertices;
  for (int i = 0; i < 30; ++i) {
    down.move(down.pose.position + Vec3(0, 0, -5e-5));
    Points raised = x;
    raised.row(2).array() += 5e-5;
    // Stating a bound on the motion changes nothing but the cost.
    up.detector.find_contacts(x, raised, up.pose, up.pose, up.contacts,
                              i % 2 ? std::optional(5.1e-5) : std::nullopt);
    x = raised;
    EXPECT_NEAR((up.force() - down.force()).norm(), 0.0, 1e-9) << i;
  }
  EXPECT_GT(up.force().z(), 0.1);
}

}  // namespace
}  // namespace argil::contact