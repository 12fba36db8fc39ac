// Times of impact with known answers, and the degenerate pairs: parallel, coplanar, touching, still, slivers.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "base/rng.h"
#include "contact/ccd.h"
#include "contact/penalty.h"

namespace argil::contact {
namespace {

constexpr double kClose = 1e-12;  // rounding of coordinates of size 1 over closing speeds of size 1

PairPath still(const std::array<Vec3, 4>& p) {
  return {p, p};
}

/// Vertex at (x, y) that goes from height z0 to z1; unit right triangle in z = 0.
PairPath falling(double x, double y, double z0, double z1) {
  PairPath path = still({Vec3(x, y, z0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  path.t1[0].z() = z1;
  return path;
}

/// Edge along x at height 0, and an edge along y that goes from height z0 to z1 at x.
PairPath crossing(double x, double z0, double z1) {
  PairPath path = still({Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(x, -1, z0), Vec3(x, 1, z0)});
  path.t1[2].z() = path.t1[3].z() = z1;
  return path;
}

TEST(VertexFace, FallMeetsAtTheTimeOfFreeFlight) {
  const auto t = find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 1.0, -3.0));
  ASSERT_TRUE(t);
  EXPECT_LE(*t, 0.25);
  EXPECT_NEAR(*t, 0.25, kClose);
}

TEST(VertexFace, PassingBesideByLittleIsNoHitAndOnTheRimIs) {
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_FALSE(find_time_of_impact(PairKind::vertex_face, falling(-off, 0.3, 1.0, -3.0))) << off;
    EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, falling(off, 0.3, 1.0, -3.0))) << off;
  }
  EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, falling(0.0, 0.3, 1.0, -3.0)));
  EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, falling(0.0, 0.0, 1.0, -3.0)));
}

TEST(VertexFace, StoppingShortByLittleIsNoHitAndJustTouchingIs) {
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    EXPECT_FALSE(find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 1.0, gap))) << gap;
    EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 1.0, -gap))) << gap;
  }
  const auto t = find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 1.0, 0.0));
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 1.0, kClose);
}

TEST(VertexFace, TouchingAtTheStartIsAHitAtZero) {
  EXPECT_EQ(find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 0.0, 1.0)), 0.0);
  EXPECT_EQ(find_time_of_impact(PairKind::vertex_face, falling(0.2, 0.3, 0.0, 0.0)), 0.0);
}

TEST(VertexFace, WithinThePlaneTheVertexMeetsTheRim) {
  // All in z = 0: the cubic is zero throughout, and the vertex reaches x = 0 half way.
  PairPath path = falling(-1.0, 0.3, 0.0, 0.0);
  path.t1[0].x() = 1.0;
  const auto t = find_time_of_impact(PairKind::vertex_face, path);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 0.5, kClose);
  path.t1[0].x() = -1e-9;
  EXPECT_FALSE(find_time_of_impact(PairKind::vertex_face, path));
}

TEST(VertexFace, TurningTriangleSweepsTheVertexUp) {
  // The corner (1, 0, −1) rises to (1, 0, 1): with f0 = 0 and f2 = (0, 1, 0) the plane is z = x(2t − 1). A
  // vertex at rest at height h over x meets it at t = (1 + h/x)/2.
  PairPath path = still({Vec3(0.25, 0.25, 0.1), Vec3(0, 0, 0), Vec3(1, 0, -1), Vec3(0, 1, 0)});
  path.t1[2].z() = 1.0;
  const auto t = find_time_of_impact(PairKind::vertex_face, path);
  ASSERT_TRUE(t);
  EXPECT_LE(*t, 0.7);
  EXPECT_NEAR(*t, 0.7, kClose);
}

TEST(VertexFace, SliverAndPointTrianglesAreStillJudged) {
  for (const double width : {1e-6, 1e-9, 0.0}) {
    PairPath path = falling(0.0, 0.0, 1.0, -1.0);
    path.t0[1] = path.t1[1] = Vec3(-1, 0, 0);
    path.t0[3] = path.t1[3] = Vec3(0, width, 0);
    EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, path)) << width;
    path.t0[0].y() = path.t1[0].y() = -1e-3;
    EXPECT_FALSE(find_time_of_impact(PairKind::vertex_face, path)) << width;
  }
  PairPath path = still({Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0)});
  path.t1[0] = Vec3(0, 0, -1);
  EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, path));
  path.t0[0].x() = 1e-3;
  EXPECT_FALSE(find_time_of_impact(PairKind::vertex_face, path));
}

TEST(EdgeEdge, CrossingEdgesMeetAtTheTimeOfFreeFlight) {
  const auto t = find_time_of_impact(PairKind::edge_edge, crossing(0.5, 1.0, -1.0));
  ASSERT_TRUE(t);
  EXPECT_LE(*t, 0.5);
  EXPECT_NEAR(*t, 0.5, kClose);
  for (const double off : {1e-3, 1e-9, 1e-12}) {
    EXPECT_FALSE(find_time_of_impact(PairKind::edge_edge, crossing(1.0 + off, 1.0, -1.0)));
    EXPECT_TRUE(find_time_of_impact(PairKind::edge_edge, crossing(1.0 - off, 1.0, -1.0)));
  }
}

TEST(EdgeEdge, ParallelEdgesMeetWhereTheyOverlapOnly) {
  PairPath path = still({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1, 0.0), Vec3(2, 1, 0.0)});
  path.t1[2].y() = path.t1[3].y() = -1.0;
  const auto t = find_time_of_impact(PairKind::edge_edge, path);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 0.5, kClose);
  path.t0[2].x() = path.t1[2].x() = 1.0 + 1e-9;  // now end to end with a gap
  EXPECT_FALSE(find_time_of_impact(PairKind::edge_edge, path));
}

TEST(EdgeEdge, ParallelEdgesAtRestSideBySideAreApart) {
  for (const double gap : {1e-3, 1e-9, 1e-13})
    EXPECT_FALSE(find_time_of_impact(
        PairKind::edge_edge, still({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(gap, 0, 0), Vec3(1 + gap, 2, 3)})))
        << gap;
}

TEST(EdgeEdge, CollinearEdgesMeetEndToEnd) {
  PairPath path = still({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0)});
  EXPECT_FALSE(find_time_of_impact(PairKind::edge_edge, path));
  path.t1[2].x() = 0.0;
  const auto t = find_time_of_impact(PairKind::edge_edge, path);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 0.5, kClose);
}

TEST(Ccd, WhatIsNotANumberCountsAsAHit) {
  PairPath path = falling(0.2, 0.3, 1.0, 0.5);
  path.t1[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(find_time_of_impact(PairKind::vertex_face, path));
}

TEST(Ccd, BernsteinFormIsTheDeterminantAtEveryTime) {
  Rng rng(7, "coplanarity");
  for (int trial = 0; trial < 50; ++trial) {
    PairPath path;
    for (auto* ends : {&path.t0, &path.t1})
      for (Vec3& p : *ends) p = Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    for (const PairKind kind : {PairKind::vertex_face, PairKind::edge_edge}) {
      const auto c = compute_coplanarity(kind, path);
      for (const double t : {0.0, 0.2, 0.5, 0.9, 1.0}) {
        const auto p = interpolate(path, t);
        const double s = 1.0 - t;
        const double cubic =
            s * s * s * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t * t * t * c[3];
        const double direct = kind == PairKind::vertex_face
                                  ? (p[2] - p[1]).cross(p[3] - p[1]).dot(p[0] - p[1])
                                  : (p[1] - p[0]).cross(p[3] - p[2]).dot(p[0] - p[2]);
        EXPECT_NEAR(cubic, direct, 1e-13);  // rounding of numbers of size 1
      }
    }
  }
}

}  // namespace
}  // namespace argil::contact
