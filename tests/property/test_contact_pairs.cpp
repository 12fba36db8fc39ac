// What is always true of a pair and of the detector, over seeded random motions: detection against dense
// sampling, invariance under rigid motions, and the carried inside flags against the geometry.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "contact/ccd.h"
#include "contact/contact.h"
#include "contact/penalty.h"
#include "contact/tool_shape.h"

namespace argil::contact {
namespace {

Vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

PairPath random_path(Rng& rng) {
  PairPath path;
  for (std::size_t i = 0; i < 4; ++i) {
    path.t0[i] = random_vector(rng, 1.0);
    path.t1[i] = random_vector(rng, 1.0);
  }
  return path;
}

/// Signed volume that vanishes where the four points are coplanar.
double determinant(PairKind kind, const std::array<Vec3, 4>& p) {
  return kind == PairKind::vertex_face ? (p[2] - p[1]).cross(p[3] - p[1]).dot(p[0] - p[1])
                                       : (p[1] - p[0]).cross(p[3] - p[2]).dot(p[0] - p[2]);
}

/// Are the crossing's parameters within the features, by at least `margin`? Solved anew, by least squares.
bool is_within(PairKind kind, const std::array<Vec3, 4>& p, double margin) {
  Eigen::Matrix<double, 3, 2> A;
  Vec3 b;
  if (kind == PairKind::vertex_face) {
    A << p[2] - p[1], p[3] - p[1];
    b = p[0] - p[1];
  } else {
    A << p[1] - p[0], p[2] - p[3];
    b = p[2] - p[0];
  }
  const Eigen::Matrix2d N = A.transpose() * A;
  const Eigen::Vector2d u = N.inverse() * (A.transpose() * b);
  const double third = kind == PairKind::vertex_face ? 1.0 - u.sum() : 1.0 - u.maxCoeff();
  return u.minCoeff() > margin && third > margin;
}

class PairKinds : public ::testing::TestWithParam<PairKind> {};

TEST_P(PairKinds, NoMeetingThatDenseSamplingSeesIsMissedOrLate) {
  constexpr int kSamples = 500;
  Rng rng(11, GetParam() == PairKind::vertex_face ? "vf" : "ee");
  int meetings = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const PairPath path = random_path(rng);
    double before = determinant(GetParam(), path.t0);
    for (int i = 1; i <= kSamples; ++i) {
      const double t = double(i) / kSamples;
      const auto p = interpolate(path, t);
      const double now = determinant(GetParam(), p);
      if ((before < 0.0) != (now < 0.0) && is_within(GetParam(), p, 0.05)) {
        const auto found = find_time_of_impact(GetParam(), path);
        ASSERT_TRUE(found) << trial;
        EXPECT_LE(*found, t) << trial;
        ++meetings;
        break;
      }
      before = now;
    }
  }
  EXPECT_GT(meetings, 100);
}

TEST_P(PairKinds, FeaturesAreApartUntilTheTimeOfImpact) {
  // The other side of safety: before the time that is reported, dense sampling sees no meeting.
  constexpr int kSamples = 500;
  Rng rng(12, "apart");
  for (int trial = 0; trial < 2000; ++trial) {
    const PairPath path = random_path(rng);
    const double until = find_time_of_impact(GetParam(), path).value_or(1.0);
    double before = determinant(GetParam(), path.t0);
    for (int i = 1; i <= kSamples; ++i) {
      const auto p = interpolate(path, until * i / kSamples);
      const double now = determinant(GetParam(), p);
      if (i < kSamples && (before < 0.0) != (now < 0.0)) {
        EXPECT_FALSE(is_within(GetParam(), p, 0.05)) << trial;
      }
      before = now;
    }
  }
}

TEST_P(PairKinds, PenaltyAgreesWithASlowWalkAlongTime) {
  // Reference: the same rule by small steps: opened by crossing from outside within the features, closed by
  // the next crossing outwards, n nᵀ(p−q) summed by midpoints. Edges whose lines cross beyond an end have
  // passed each other: outside is the other side then. A face's outside is always the same.
  constexpr int kSteps = 4000;
  Rng rng(13, GetParam() == PairKind::vertex_face ? "vf" : "ee");
  int with_contact = 0;
  int twice = 0;
  int passed = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const PairPath path = random_path(rng);
    const bool vf = GetParam() == PairKind::vertex_face;
    double outside = vf || determinant(GetParam(), path.t0) > 0.0 ? 1.0 : -1.0;
    bool inside = false;
    bool is_clear = true;  // no crossing so near a rim that the step decides
    int intervals = 0;
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < kSteps; ++i) {
      const auto p = interpolate(path, (i + 0.5) / kSteps);
      const double before = outside * determinant(GetParam(), interpolate(path, double(i) / kSteps));
      const double after = outside * determinant(GetParam(), interpolate(path, double(i + 1) / kSteps));
      if (before >= 0.0 && after < 0.0) {
        if (is_within(GetParam(), p, -0.02) != is_within(GetParam(), p, 0.02)) is_clear = false;
        if (is_within(GetParam(), p, 0.0) && !inside)
          ++intervals, inside = true;
        else if (!vf && !inside)
          outside = -outside, ++passed;
      } else if (before < 0.0 && after >= 0.0) {
        inside = false;
      }
      if (!inside) continue;
      const Vec3 n = (vf ? (p[2] - p[1]).cross(p[3] - p[1]) : (p[1] - p[0]).cross(p[3] - p[2])).normalized();
      sum += n.dot(p[0] - p[vf ? 1 : 2]) * n / kSteps;
    }
    if (!is_clear) continue;
    const Penalty penalty =
        vf ? compute_vertex_face_penalty(path, false) : compute_edge_edge_penalty(path, false, 0.0);
    EXPECT_EQ(penalty.num_intervals, intervals) << trial;
    EXPECT_EQ(penalty.inside_at_end, inside) << trial;
    EXPECT_NEAR((penalty.integral - sum).norm(), 0.0, 2e-3) << trial;  // first order in the step at the ends
    with_contact += intervals > 0 ? 1 : 0;
    twice += intervals > 1 ? 1 : 0;
  }
  EXPECT_GT(with_contact, 30);
  std::printf("%d pairs in contact, %d of them twice; %d crossings beyond an end\n", with_contact, twice,
              passed);
}

TEST_P(PairKinds, PenaltyTurnsAndMovesWithTheFrame) {
  Rng rng(14, "frame");
  int with_contact = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const PairPath path = random_path(rng);
    const Quat R =
        Quat(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized();
    const Vec3 shift = random_vector(rng, 1.0);
    PairPath moved;
    for (std::size_t i = 0; i < 4; ++i) {
      moved.t0[i] = R * path.t0[i] + shift;
      moved.t1[i] = R * path.t1[i] + shift;
    }
    const auto compute = [&](const PairPath& p) {
      return GetParam() == PairKind::vertex_face ? compute_vertex_face_penalty(p, false)
                                                 : compute_edge_edge_penalty(p, false, 0.0);
    };
    const Penalty here = compute(path);
    EXPECT_NEAR((compute(moved).integral - R * here.integral).norm(), 0.0, 1e-10) << trial;
    with_contact += here.num_intervals;
  }
  EXPECT_GT(with_contact, 10);
}

INSTANTIATE_TEST_SUITE_P(Contact, PairKinds, ::testing::Values(PairKind::vertex_face, PairKind::edge_edge),
                         [](const ::testing::TestParamInfo<PairKind>& kind) {
                           return kind.param == PairKind::vertex_face ? "VertexFace" : "EdgeEdge";
                         });

/// Solid angle of a closed surface seen from p over 4π: 1 inside, 0 outside (Van Oosterom and Strackee 1983).
double winding_number(const Points& x, const Triangles& triangles, const Vec3& p) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vec3 a = x.col(triangles(0, t)) - p;
    const Vec3 b = x.col(triangles(1, t)) - p;
    const Vec3 c = x.col(triangles(2, t)) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

TEST(Detector, CarriesJustTheVerticesThatAreInside) {
  // A bumpy body that wobbles and a capsule that tumbles through and around it, by small and by long steps.
  // After every interval the vertices that are carried must be those that the winding number finds inside: a
  // missing one is a miss, one too many a ghost.
  Rng rng(21, "tumble");
  mesh::TriangleMesh body = make_sphere_tool(0.03, 2);
  for (int v = 0; v < body.num_vertices(); ++v) body.vertices.col(v) *= rng.uniform(0.7, 1.2);
  const mesh::TriangleMesh tool = make_capsule_tool(0.006, 0.02, 10);
  ContactDetector detector(body.triangles, body.num_vertices(), tool, {100.0, 100.0});
  Pose pose{Vec3(0.08, 0.0, 0.0), Quat::Identity()};
  Points x = body.vertices;
  Contacts contacts;
  int carried = 0;
  int missed = 0;
  int ghosts = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const double step = tick % 7 == 0 ? 0.02 : 0.002;
    Pose next;
    next.position = pose.position + random_vector(rng, step) - 0.05 * pose.position;
    next.orientation =
        (pose.orientation * Quat(1.0, rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), 0.0)).normalized();
    Points x_next = body.vertices;
    for (Eigen::Index v = 0; v < x.cols(); ++v)
      x_next.col(v) *= 1.0 + 0.05 * std::sin(0.3 * tick + static_cast<double>(v % 5));
    detector.find_contacts(x, x_next, pose, next, contacts);
    x = x_next;
    pose = next;

    Vec3 body_force = Vec3::Zero();
    for (const Contact& c : contacts.contacts) body_force += c.force;
    EXPECT_NEAR((body_force + contacts.force_on_tool).norm(), 0.0, 1e-10);
    EXPECT_TRUE(contacts.force_on_tool.allFinite());

    const ContactState state = detector.state();
    Points placed = pose.orientation.toRotationMatrix() * tool.vertices;
    placed.colwise() += pose.position;
    const auto compare = [&](const std::vector<int>& inside, const Points& vertices, const Points& surface,
                             const Triangles& triangles) {
      std::vector<bool> is_carried(static_cast<std::size_t>(vertices.cols()), false);
      for (const int v : inside) is_carried[static_cast<std::size_t>(v)] = true;
      for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
        const double w = winding_number(surface, triangles, vertices.col(v));
        carried += w > 0.5 ? 1 : 0;
        missed += w > 0.5 && !is_carried[static_cast<std::size_t>(v)] ? 1 : 0;
        ghosts += w < 0.5 && is_carried[static_cast<std::size_t>(v)] ? 1 : 0;
      }
    };
    compare(state.tool_vertex, placed, x, body.triangles);
    compare(state.body_vertex, x, placed, tool.triangles);
  }
  std::printf("%d vertices inside over all intervals, %d missed, %d ghosts\n", carried, missed, ghosts);
  EXPECT_GT(carried, 2000);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(ghosts, 0);
}

}  // namespace
}  // namespace argil::contact
