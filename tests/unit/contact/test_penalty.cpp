// Eqs. 7 and 8 at one pair: closed forms where the normal rests, an independent quadrature where it turns.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "contact/penalty.h"

namespace argil::contact {
namespace {

constexpr double kRound = 1e-13;  // rounding of numbers of size 1

PairPath still(const std::array<Vec3, 4>& p) {
  return {p, p};
}

PairPath falling(double z0, double z1, double x = 0.2, double y = 0.3) {
  PairPath path = still({Vec3(x, y, z0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)});
  path.t1[0].z() = z1;
  return path;
}

/// ∫ n nᵀ(p−q) dt by Simpson's rule on 20 000 pieces, with the normal written out anew.
Vec3 integrate_slowly(const std::function<Vec3(double)>& n, const std::function<Vec3(double)>& pq, double a,
                      double b) {
  constexpr int kPieces = 20000;
  const auto f = [&](double t) -> Vec3 {
    const Vec3 unit = n(t) / std::sqrt(n(t).dot(n(t)));
    return unit.dot(pq(t)) * unit;
  };
  Vec3 sum = f(a) + f(b);
  for (int i = 1; i < kPieces; ++i) sum += (i % 2 ? 4.0 : 2.0) * f(a + (b - a) * i / kPieces);
  return sum * (b - a) / (3.0 * kPieces);
}

TEST(VertexFacePenalty, VertexThroughARestingTriangleIsAParabola) {
  // z(t) = 1 − 4t: inside from ¼; ∫ z dt from ¼ to 1 = −4·(¾)²/2.
  const Penalty p = compute_vertex_face_penalty(falling(1.0, -3.0), false);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_NEAR(p.intervals[0].begin, 0.25, kRound);
  EXPECT_EQ(p.intervals[0].end, 1.0);
  EXPECT_NEAR((p.integral - Vec3(0, 0, -4.0 * 0.75 * 0.75 / 2.0)).norm(), 0.0, kRound);
  EXPECT_NEAR(p.duration, 0.75, kRound);
  EXPECT_TRUE(p.inside_at_end);
  // Shares at the entry: the vertex itself, and the barycentric coordinates of (0.2, 0.3).
  EXPECT_EQ(p.weights[0], 1.0);
  EXPECT_NEAR(p.weights[1], 0.5, kRound);
  EXPECT_NEAR(p.weights[2], 0.2, kRound);
  EXPECT_NEAR(p.weights[3], 0.3, kRound);
}

TEST(VertexFacePenalty, RestingInsideGivesTheFullDepthOnlyWhenCarried) {
  EXPECT_NEAR(compute_vertex_face_penalty(falling(-0.1, -0.1), true).integral.z(), -0.1, kRound);
  EXPECT_EQ(compute_vertex_face_penalty(falling(-0.1, -0.1), false).num_intervals, 0);
}

TEST(VertexFacePenalty, LeavingClosesTheIntervalAtTheCrossing) {
  // z = −1 + 4t: inside until ¼; ∫ = −1·¼/2.
  const Penalty p = compute_vertex_face_penalty(falling(-1.0, 3.0), true);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_EQ(p.intervals[0].begin, 0.0);
  EXPECT_NEAR(p.intervals[0].end, 0.25, kRound);
  EXPECT_NEAR(p.integral.z(), -0.125, kRound);
  EXPECT_FALSE(p.inside_at_end);
}

TEST(VertexFacePenalty, StartingOnThePlaneAndGoingInOpensAtZero) {
  const Penalty p = compute_vertex_face_penalty(falling(0.0, -1.0), false);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_NEAR(p.intervals[0].begin, 0.0, kRound);
  EXPECT_NEAR(p.integral.z(), -0.5, kRound);
  EXPECT_EQ(compute_vertex_face_penalty(falling(0.0, 1.0), false).num_intervals, 0);
}

TEST(VertexFacePenalty, CrossingThePlaneBesideTheTriangleIsNoEntry) {
  EXPECT_EQ(compute_vertex_face_penalty(falling(1.0, -3.0, -0.01, 0.3), false).num_intervals, 0);
  EXPECT_EQ(compute_vertex_face_penalty(falling(1.0, -3.0, 0.6, 0.6), false).num_intervals, 0);
}

TEST(VertexFacePenalty, PassingFromBehindIsNoEntry) {
  EXPECT_EQ(compute_vertex_face_penalty(falling(-3.0, 1.0), false).num_intervals, 0);
}

TEST(VertexFacePenalty, EndingSidewaysCutsTheInterval) {
  const Penalty p = compute_vertex_face_penalty(falling(-0.2, -0.2), true, 0.25);
  EXPECT_NEAR(p.integral.z(), -0.05, kRound);
  EXPECT_NEAR(p.duration, 0.25, kRound);
  EXPECT_FALSE(p.inside_at_end);
}

TEST(VertexFacePenalty, TurningNormalAgreesWithAnIndependentQuadrature) {
  // f1 rises from (1, 0, −1) to (1, 0, 1): n(t) = (1−2t, 0, 1) up to length, plane z = x(2t−1). The vertex
  // rests at (¼, ¼, 0.1): outside until t = 0.7, then inside.
  PairPath path = still({Vec3(0.25, 0.25, 0.1), Vec3(0, 0, 0), Vec3(1, 0, -1), Vec3(0, 1, 0)});
  path.t1[2].z() = 1.0;
  const Penalty p = compute_vertex_face_penalty(path, false);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_NEAR(p.intervals[0].begin, 0.7, kRound);
  const Vec3 slow = integrate_slowly([](double t) { return Vec3(1 - 2 * t, 0, 1); },
                                     [](double) { return Vec3(0.25, 0.25, 0.1); }, 0.7, 1.0);
  EXPECT_NEAR((p.integral - slow).norm(), 0.0, 1e-12);
  // Without the unit length the result would be off by |n|² along the way: far more than the tolerance.
  EXPECT_GT(slow.norm(), 1e-3);
}

/// Edge a along x at height z0 → z1 over edge b along y at rest: b's body lies below.
PairPath crossing_edges(double z0, double z1) {
  PairPath path = still({Vec3(-1, 0, z0), Vec3(1, 0, z0), Vec3(0.2, -1, 0), Vec3(0.2, 3, 0)});
  path.t1[0].z() = path.t1[1].z() = z1;
  return path;
}

TEST(EdgeEdgePenalty, CrossingEdgesGiveTheSameParabola) {
  const Penalty p = compute_edge_edge_penalty(crossing_edges(1.0, -3.0), false, 0.0);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_NEAR(p.intervals[0].begin, 0.25, kRound);
  EXPECT_NEAR((p.integral - Vec3(0, 0, -1.125)).norm(), 0.0, kRound);
  EXPECT_NEAR(p.weights[0], 0.4, kRound);  // x = 0.2 of −1 … 1
  EXPECT_NEAR(p.weights[1], 0.6, kRound);
  EXPECT_NEAR(p.weights[2], 0.75, kRound);  // y = 0 of −1 … 3
  EXPECT_NEAR(p.weights[3], 0.25, kRound);
}

TEST(EdgeEdgePenalty, TheOrderOfEndsAndOfApproachDoesNotMatter) {
  for (const double sign : {1.0, -1.0}) {
    PairPath path = crossing_edges(sign * 1.0, sign * -3.0);
    const Vec3 expected(0, 0, sign * -1.125);
    EXPECT_NEAR((compute_edge_edge_penalty(path, false, 0.0).integral - expected).norm(), 0.0, kRound);
    std::swap(path.t0[0], path.t0[1]);
    std::swap(path.t1[0], path.t1[1]);
    EXPECT_NEAR((compute_edge_edge_penalty(path, false, 0.0).integral - expected).norm(), 0.0, kRound);
  }
}

TEST(EdgeEdgePenalty, BeyondTheEndIsNoEntryAndRestingInsideNeedsTheFlag) {
  PairPath path = crossing_edges(1.0, -3.0);
  for (auto* ends : {&path.t0, &path.t1}) (*ends)[2].x() = (*ends)[3].x() = 1.01;
  EXPECT_EQ(compute_edge_edge_penalty(path, false, 0.0).num_intervals, 0);
  EXPECT_EQ(compute_edge_edge_penalty(crossing_edges(-0.1, -0.1), false, 0.0).num_intervals, 0);
  EXPECT_NEAR(compute_edge_edge_penalty(crossing_edges(-0.1, -0.1), true, 0.0).integral.z(), -0.1, kRound);
}

TEST(EdgeEdgePenalty, TurningEdgesAgreeWithAnIndependentQuadrature) {
  PairPath path = crossing_edges(0.3, -0.5);
  path.t1[1] += Vec3(0.1, 0.8, -0.4);
  path.t1[3] += Vec3(-0.6, 0.0, -0.2);
  const auto at = [&](std::size_t i, double t) -> Vec3 { return (1 - t) * path.t0[i] + t * path.t1[i]; };
  const auto n = [&](double t) -> Vec3 { return (at(1, t) - at(0, t)).cross(at(3, t) - at(2, t)); };
  const auto pq = [&](double t) -> Vec3 { return at(0, t) - at(2, t); };
  const Penalty p = compute_edge_edge_penalty(path, false, 0.0);
  ASSERT_EQ(p.num_intervals, 1);
  const double begin = p.intervals[0].begin;
  EXPECT_NEAR(n(begin).dot(pq(begin)), 0.0, kRound);
  EXPECT_GT(begin, 0.0);
  EXPECT_NEAR((p.integral - integrate_slowly(n, pq, begin, 1.0)).norm(), 0.0, 1e-12);
}

/// Edge b along x from −1 to 1 at rest. Edge a in the plane x = 2 − 2t from (y, z) = (−½ − t, A − 3t/2) to
/// (1, t), A = 3/16: its line passes z = (t − ¼)(t − ¾)/(y₁ − y₀) at y = 0. At t = ¼ it crosses the line of b
/// beyond b's end, at t = ¾ it crosses b itself, the other way.
PairPath passing_and_then_crossing(double sign) {
  PairPath path = still({Vec3(2, -0.5, sign * 0.1875), Vec3(2, 1, 0), Vec3(-1, 0, 0), Vec3(1, 0, 0)});
  path.t1[0] = Vec3(0, -1.5, sign * -1.3125);
  path.t1[1] = Vec3(0, 1, sign * 1.0);
  return path;
}

TEST(EdgeEdgePenalty, EdgesThatPassedEachOtherBeyondAnEndMeetOnTheWayBack) {
  for (const double sign : {1.0, -1.0}) {
    const PairPath path = passing_and_then_crossing(sign);
    const Penalty p = compute_edge_edge_penalty(path, false, 0.0);
    ASSERT_EQ(p.num_intervals, 1);
    EXPECT_NEAR(p.intervals[0].begin, 0.75, kRound);
    EXPECT_EQ(p.intervals[0].end, 1.0);
    EXPECT_TRUE(p.inside_at_end);
    EXPECT_NEAR(p.weights[1], 1.25 / 2.25, kRound);  // y = 0 of −1.25 … 1
    EXPECT_NEAR(p.weights[3], 0.75, kRound);         // x = ½ of −1 … 1
    const auto n = [&](double t) -> Vec3 { return Vec3(0, -sign * (2.5 * t - 0.1875), 1.5 + t); };
    const auto pq = [&](double t) -> Vec3 { return Vec3(0, -0.5 - t, sign * (0.1875 - 1.5 * t)); };
    const Vec3 slow = integrate_slowly(n, pq, 0.75, 1.0);
    EXPECT_NEAR((p.integral - slow).norm(), 0.0, 1e-12);
    EXPECT_GT(sign * p.integral.z(), 0.004);  // a's line is above b, where it was before it passed the end
    // n is turned so that nᵀ(p−q) > 0 before the entry: here where a lies below.
    EXPECT_LT(p.orientation * sign * (path.t1[1] - path.t1[0]).cross(path.t1[3] - path.t1[2]).z(), 0.0);
  }
}

TEST(EdgeEdgePenalty, EdgesThatAreParallelForAMomentMeetNothing) {
  // a turns about z over b, 0.3 apart throughout; at ½, and at the start, it is parallel to b.
  for (const double from : {-1.0, 0.0}) {
    PairPath path = still({Vec3(-1, -from, 0.3), Vec3(1, from, 0.3), Vec3(-1, 0, 0), Vec3(1, 0, 0)});
    path.t1[0].y() = -1.0;
    path.t1[1].y() = 1.0;
    for (const double sign : {1.0, -1.0}) {
      for (auto* ends : {&path.t0, &path.t1}) (*ends)[0].z() = (*ends)[1].z() = sign * 0.3;
      const Penalty p = compute_edge_edge_penalty(path, false, 0.0);
      EXPECT_EQ(p.num_intervals, 0) << from;
      EXPECT_EQ(p.integral, Vec3::Zero()) << from;
    }
  }
}

TEST(EdgeEdgePenalty, EdgesThatAreParallelForAMomentStayInside) {
  // a turns likewise while it goes down, z = ¼ − t: inside from ¼, parallel at ½. ∫ (¼ − t) dt = −(¾)²/2.
  PairPath path = still({Vec3(-1, -1, 0.25), Vec3(1, 1, 0.25), Vec3(-1, 0, 0), Vec3(1, 0, 0)});
  path.t1[0] = Vec3(-1, 1, -0.75);
  path.t1[1] = Vec3(1, -1, -0.75);
  const Penalty p = compute_edge_edge_penalty(path, false, 0.0);
  ASSERT_EQ(p.num_intervals, 1);
  EXPECT_NEAR(p.intervals[0].begin, 0.25, kRound);
  EXPECT_EQ(p.intervals[0].end, 1.0);
  EXPECT_NEAR((p.integral - Vec3(0, 0, -0.28125)).norm(), 0.0, kRound);
  EXPECT_GT(p.orientation * (path.t1[1] - path.t1[0]).cross(path.t1[3] - path.t1[2]).z(), 0.0);
}

}  // namespace
}  // namespace argil::contact
