// Detection never rejects a true meeting. The meetings are exact: all numbers are dyadic, the place and the
// time of the meeting are chosen first, and the last point's path is solved for without rounding. Half of
// them are degenerate: points that coincide, parallel edges, flat and still motion, slivers, far from the
// origin, near the ends of double's range.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "base/rng.h"
#include "contact/ccd.h"
#include "contact/four_pairs.h"

namespace argil::contact {
namespace {

using Int3 = Eigen::Matrix<std::int64_t, 3, 1>;

int random_int(Rng& rng, int low, int high) {
  return low + static_cast<int>(rng.uniform() * (high - low + 1));
}

/// Coordinates that are whole multiples of the grid.
struct Grid {
  int half = 512;         // coordinates −half … half
  Vec3 spacing;           // powers of two, or 0: flat
  Vec3 offset;            // the scene's place
  bool is_still = false;  // nothing but the last point moves

  explicit Grid(Rng& rng) {
    const bool is_degenerate = rng.uniform() < 0.5;
    spacing.setConstant(1.0 / 512.0);
    offset.setZero();
    if (!is_degenerate) return;
    half = std::array{1, 2, 512}[static_cast<std::size_t>(random_int(rng, 0, 2))];
    is_still = rng.uniform() < 0.2;
    const int axis = random_int(rng, 0, 2);
    if (rng.uniform() < 0.3) spacing(axis) *= std::array{0.0, 0x1p-12, 0x1p-20}[random_place(rng)];
    if (rng.uniform() < 0.3) spacing *= std::array{0x1p-280, 0x1p-345, 0x1p345}[random_place(rng)];
    if (rng.uniform() < 0.3) offset = 0x1p18 * spacing.maxCoeff() * Vec3(1, -1, 0.5);
  }
  Vec3 point(Rng& rng) const {
    Vec3 p = offset;
    for (Eigen::Index i = 0; i < 3; ++i) p(i) += spacing(i) * random_int(rng, -half, half);
    return p;
  }
  static std::size_t random_place(Rng& rng) { return static_cast<std::size_t>(random_int(rng, 0, 2)); }
};

/// Ends of a linear path that is at `p` at time t, one of 0, ¼, ½, ¾, 1; the free end is random.
void pass_through(const Vec3& p, double t, const Vec3& free_end, Vec3& x_t0, Vec3& x_t1) {
  if (t <= 0.5) {
    x_t1 = t == 0.0 ? free_end : Vec3(p + (1.0 / t - 1.0) * (p - free_end));
    x_t0 = t == 0.0 ? p : free_end;
  } else {
    x_t1 = t == 1.0 ? p : free_end;
    x_t0 = t == 1.0 ? free_end : Vec3(p + t / (1.0 - t) * (p - free_end));
  }
}

Vec3 at(const PairPath& path, std::size_t i, double t) {
  return (1.0 - t) * path.t0[i] + t * path.t1[i];
}

struct Meeting {
  PairPath path;
  double time = 0.0;
};

Meeting make_meeting(PairKind kind, Rng& rng) {
  const Grid grid(rng);
  Meeting meeting;
  meeting.time = 0.25 * random_int(rng, 0, 4);
  const double t = meeting.time;
  PairPath& path = meeting.path;
  for (std::size_t i = 0; i < 4; ++i) {
    path.t0[i] = grid.point(rng);
    path.t1[i] = grid.is_still ? path.t0[i] : grid.point(rng);
  }
  const double w = 0.25 * random_int(rng, 0, 4);
  if (kind == PairKind::vertex_face) {
    const double u = 0.25 * random_int(rng, 0, static_cast<int>(4.0 * (1.0 - w)));
    const Vec3 q = w * at(path, 1, t) + u * at(path, 2, t) + (1.0 - w - u) * at(path, 3, t);
    pass_through(q, t, grid.point(rng), path.t0[0], path.t1[0]);
    return meeting;
  }
  // Where edge b is met, and the corner of edge a so that a passes there: its end, a half or a quarter along.
  const Vec3 q = w * at(path, 2, t) + (1.0 - w) * at(path, 3, t);
  const double s = std::array{1.0, 0.5, 0.25}[Grid::random_place(rng)];
  const Vec3 corner = q + (1.0 / s - 1.0) * (q - at(path, 0, t));
  pass_through(corner, t, grid.point(rng), path.t0[1], path.t1[1]);
  return meeting;
}

/// Points of four pairs: point i of pair k in column 4 k + i, and a column more.
struct FourPaths {
  Points t0 = Points::Zero(3, 17);
  Points t1 = Points::Zero(3, 17);

  void set(int pair, const PairPath& path) {
    for (int i = 0; i < 4; ++i) {
      t0.col(4 * pair + i) = path.t0[static_cast<std::size_t>(i)];
      t1.col(4 * pair + i) = path.t1[static_cast<std::size_t>(i)];
    }
  }
  FourPairs pairs() const {
    FourPairs out;
    for (int i = 0; i < 4; ++i) set_points(out, i, t0, t1, {i, 4 + i, 8 + i, 12 + i});
    return out;
  }
};

bool has(unsigned bits, int pair) {
  return (bits >> pair & 1U) != 0;
}

class CcdFilter : public ::testing::TestWithParam<PairKind> {};

TEST_P(CcdFilter, NeverRejectsATrueMeetingNorReportsItLate) {
  constexpr int kMeetings = 1'000'000;
  Rng rng(31, GetParam() == PairKind::vertex_face ? "vf" : "ee");
  int rejected = 0;
  int missed = 0;
  int late = 0;
  FourPaths four;
  for (int i = 0; i < kMeetings; ++i) {
    const Meeting meeting = make_meeting(GetParam(), rng);
    four.set(i % 4, meeting.path);
    if (i % 4 == 3) {
      ASSERT_EQ(find_coplanar(GetParam(), four.pairs()), 15U) << i;
    }
    rejected += filter_pair(GetParam(), meeting.path).can_meet ? 0 : 1;
    const auto found = find_time_of_impact(GetParam(), meeting.path);
    missed += found ? 0 : 1;
    late += found && *found > meeting.time ? 1 : 0;
  }
  EXPECT_EQ(rejected, 0);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(late, 0);
}

TEST_P(CcdFilter, RejectsExactlyWhatTheSignsOfTheCubicTell) {
  // On whole numbers the Bernstein coefficients are exact. Reference: they are the mean of det(e₁, e₂, w)
  // with one, or two, of its three columns taken at t = 1 and the others at t = 0.
  const bool face = GetParam() == PairKind::vertex_face;
  Rng rng(32, face ? "vf" : "ee");
  int by_signs = 0;
  int overlapping = 0;
  FourPaths four;
  unsigned have_one_sign = 0;
  for (int trial = 0; trial < 200'000; ++trial) {
    PairPath path;
    std::array<std::array<Int3, 3>, 2> column;  // e₁, e₂, w at either end
    for (std::size_t end = 0; end < 2; ++end) {
      std::array<Int3, 4> x;
      for (std::size_t i = 0; i < 4; ++i) {
        for (Eigen::Index k = 0; k < 3; ++k) x[i](k) = random_int(rng, -8, 8);
        (end == 0 ? path.t0 : path.t1)[i] = x[i].cast<double>();
      }
      column[end] = {face ? x[2] - x[1] : x[1] - x[0], face ? x[3] - x[1] : x[3] - x[2],
                     x[0] - x[face ? 1 : 2]};
    }
    std::array<std::int64_t, 4> c = {};
    for (std::size_t ends = 0; ends < 8; ++ends) {
      const Int3& e1 = column[ends & 1][0];
      const Int3& e2 = column[ends >> 1 & 1][1];
      c[(ends & 1) + (ends >> 1 & 1) + (ends >> 2)] += e1.cross(e2).dot(column[ends >> 2][2]);
    }
    const bool one_sign =
        *std::min_element(c.begin(), c.end()) > 0 || *std::max_element(c.begin(), c.end()) < 0;
    four.set(trial % 4, path);
    have_one_sign |= one_sign ? 1U << trial % 4 : 0U;
    if (trial % 4 == 3) {
      EXPECT_EQ(find_coplanar(GetParam(), four.pairs()), 15U & ~have_one_sign) << trial;
      have_one_sign = 0;
    }
    const bool rejected = !filter_pair(GetParam(), path).can_meet;
    if (one_sign) {
      EXPECT_TRUE(rejected) << trial;
    }
    // What else is rejected lies apart along an axis.
    const std::size_t split = face ? 1 : 2;
    bool boxes_apart = false;
    for (Eigen::Index k = 0; k < 3; ++k) {
      std::array<double, 2> low = {1e300, 1e300};
      std::array<double, 2> high = {-1e300, -1e300};
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t side = i < split ? 0 : 1;
        low[side] = std::min({low[side], path.t0[i](k), path.t1[i](k)});
        high[side] = std::max({high[side], path.t0[i](k), path.t1[i](k)});
      }
      boxes_apart = boxes_apart || low[0] > high[1] || low[1] > high[0];
    }
    EXPECT_EQ(rejected, one_sign || boxes_apart) << trial;
    overlapping += boxes_apart ? 0 : 1;
    by_signs += !boxes_apart && one_sign ? 1 : 0;
  }
  std::printf("of %d pairs with boxes that overlap, the signs reject %d\n", overlapping, by_signs);
  EXPECT_GT(by_signs, overlapping / 10);
}

TEST_P(CcdFilter, OfFourPairsKeepsAllThatOfOneKeeps) {
  Rng rng(33, GetParam() == PairKind::vertex_face ? "vf" : "ee");
  int left_out = 0;
  for (int trial = 0; trial < 50'000; ++trial) {
    FourPaths four;
    four.t0 = four.t0.unaryExpr([&](double) { return rng.uniform(); });
    four.t1 = four.t0 + 0.2 * four.t0.unaryExpr([&](double) { return rng.uniform() - 0.5; });
    const double separation = trial % 2 == 0 ? 0.0 : 0.1 * rng.uniform();
    const unsigned kept = find_coplanar(GetParam(), four.pairs(), separation);
    for (int pair = 0; pair < 4; ++pair) {
      PairPath path;
      for (int i = 0; i < 4; ++i) {
        path.t0[static_cast<std::size_t>(i)] = four.t0.col(4 * pair + i);
        path.t1[static_cast<std::size_t>(i)] = four.t1.col(4 * pair + i);
      }
      EXPECT_TRUE(has(kept, pair) || !filter_pair(GetParam(), path, separation).can_meet) << trial;
      left_out += has(kept, pair) ? 0 : 1;
    }
  }
  EXPECT_GT(left_out, 100'000);  // half of them
}

TEST_P(CcdFilter, WhatIsNotANumberIsKept) {
  FourPaths four;
  four.t0.setRandom();
  four.t1 = four.t0;
  four.t0(0, 0) = std::nan("");
  four.t1(1, 5) = HUGE_VAL;
  EXPECT_EQ(find_coplanar(GetParam(), four.pairs()) & 3U, 3U);
  EXPECT_EQ(find_alongside(four.pairs()) & 1U, 1U);
}

TEST(EdgeFilter, FindsTheLinesOfEdgesThatAreNearestWithinBoth) {
  // On whole numbers the places s/d and r/d along the edges are exact.
  Rng rng(34, "alongside");
  int within = 0;
  for (int trial = 0; trial < 50'000; ++trial) {
    FourPaths four;
    for (Points* x : {&four.t0, &four.t1})
      *x = x->unaryExpr([&](double) { return static_cast<double>(random_int(rng, -8, 8)); });
    const unsigned bits = find_alongside(four.pairs());
    for (int pair = 0; pair < 4; ++pair) {
      bool is_alongside = false;
      for (const Points* x : {&four.t0, &four.t1}) {
        const auto point = [&](int i) -> Int3 { return x->col(4 * pair + i).cast<std::int64_t>(); };
        const Int3 a = point(1) - point(0), b = point(3) - point(2), w = point(2) - point(0);
        const std::int64_t d = a.dot(a) * b.dot(b) - a.dot(b) * a.dot(b);
        const std::int64_t s = w.dot(a) * b.dot(b) - w.dot(b) * a.dot(b);
        const std::int64_t r = w.dot(a) * a.dot(b) - w.dot(b) * a.dot(a);
        is_alongside = is_alongside || d == 0 || (s >= 0 && s <= d && r >= 0 && r <= d);
      }
      EXPECT_EQ(has(bits, pair), is_alongside) << trial;
      within += is_alongside ? 1 : 0;
    }
  }
  EXPECT_GT(within, 5000);
}

INSTANTIATE_TEST_SUITE_P(Contact, CcdFilter, ::testing::Values(PairKind::vertex_face, PairKind::edge_edge),
                         [](const ::testing::TestParamInfo<PairKind>& kind) {
                           return kind.param == PairKind::vertex_face ? "VertexFace" : "EdgeEdge";
                         });

}  // namespace
}  // namespace argil::contact
