// Laws of large strain, eight tets at once against one point: small strains and large, with plastic strain
// and without, in batches that are full and not.
#include "solid/hencky_lanes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/mandel.h"
#include "base/ordered_loops.h"
#include "base/rng.h"
#include "solid/element.h"

namespace argil::solid {
namespace {

constexpr int kTets = 3 * kLanes + 5;

/// A turned stretch of about 1 ± size.
Mat3 make_motion_of(Rng& rng, double size) {
  const Vec3 turn(rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0));
  Mat3 stretch = Mat3::Identity();
  for (int k = 0; k < 9; ++k) stretch(k) += rng.uniform(-size, size);
  return Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * stretch;
}

struct Tets {
  StrainModel model;
  Eigen::Matrix3Xd gradient{3, 4 * kTets}, force{3, 4 * kTets}, F{3, 3 * kTets}, R{3, 3 * kTets};
  TensorField strain{6, kTets}, plastic{6, kTets};
  Field weight{kTets}, lambda{kTets}, mu{kTets}, pressure{kTets}, yield{kTets};
  Eigen::Matrix<double, 9, Eigen::Dynamic> pairs{9, kPairBlocks* kTets};

  explicit Tets(StrainModel of = StrainModel::hencky) : model(of) {
    Rng rng(11);
    for (int t = 0; t < kTets; ++t) {
      Mat34 rest;
      rest << 0, 1, 0.1, 0.2, 0, 0.1, 1.2, 0.3, 0, -0.1, 0.2, 0.9;
      for (int i = 0; i < 12; ++i) rest(i) += rng.uniform(-0.1, 0.1);
      const TetGeometry tet = make_tet_geometry(rest);
      gradient.middleCols<4>(4 * t) = tet.gradient;
      weight(t) = tet.volume;
      const double sizes[] = {1e-9, 1e-3, 0.04, 0.35};
      F.middleCols<3>(3 * t) = make_motion_of(rng, sizes[t % 4]);
      const PointMotion motion = make_motion(model, F.middleCols<3>(3 * t));
      R.middleCols<3>(3 * t) = motion.R;
      strain.col(t) = compute_strain(motion.F, motion.R);
      const bool is_elastic = find_law(model).plastic_split == PlasticSplit::none;
      for (int k = 0; k < 6; ++k)
        plastic(k, t) = is_elastic || t % 3 == 0 || t < kLanes ? 0.0 : rng.uniform(-0.4, 0.4);
      plastic.col(t).head<3>().array() -= plastic.col(t).head<3>().sum() / 3.0;
      lambda(t) = rng.uniform(1e3, 1e5);
      mu(t) = rng.uniform(1e3, 1e5);
      pressure(t) = rng.uniform(-1e3, 1e3);
      yield(t) = rng.uniform(0.0, 0.3);
    }
  }
  PointMotion motion(int t) const { return make_motion(model, F.middleCols<3>(3 * t)); }
  Elasticity elasticity(int t) const { return {lambda(t), mu(t)}; }
  ForceArrays arrays(bool with_pressure) {
    return {gradient.data(), R.data(),      strain.data(), plastic.data(),
            weight.data(),   lambda.data(), mu.data(),     with_pressure ? pressure.data() : nullptr,
            false,           force.data()};
  }
  void find_stiffness(double exact, double kept, bool flows = false) {
    const TangentArrays tangents{
        gradient.data(), F.data(), plastic.data(), weight.data(), lambda.data(),
        mu.data(),       exact,    kept,           pairs.data(),  flows ? yield.data() : nullptr};
    OrderedRuns(1).each(kTets, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      find_law(model).lanes.stiffness(tangents, begin, end);
    });
  }
};

template <class Body>
void each_batch(Body body) {
  OrderedRuns(1).each(kTets, body);
}

class LargeStrainLanes : public testing::TestWithParam<StrainModel> {
 protected:
  Tets tets{GetParam()};
  const ElasticLaw::Lanes& lanes = find_law(GetParam()).lanes;
};
INSTANTIATE_TEST_SUITE_P(Laws, LargeStrainLanes, testing::Values(StrainModel::hencky, StrainModel::curnier),
                         [](const auto& law) { return std::string(find_law(law.param).name); });

TEST_P(LargeStrainLanes, PressAsThePointDoes) {
  for (const bool with_pressure : {false, true}) {
    each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      lanes.forces(tets.arrays(with_pressure), begin, end);
    });
    for (int t = 0; t < kTets; ++t) {
      Elasticity e = tets.elasticity(t);
      if (with_pressure) {
        e.excess_bulk = tets.pressure(t);
        e.volume_change = 1.0;
      }
      const Mat34 expected = compute_element_force({tets.gradient.middleCols<4>(4 * t), tets.weight(t)},
                                                   GetParam(), tets.motion(t), tets.plastic.col(t), e);
      EXPECT_LT((tets.force.middleCols<4>(4 * t) - expected).norm(), 1e-12 * expected.norm() + 1e-10) << t;
    }
  }
}

TEST_P(LargeStrainLanes, HaveTheEnergyOfThePoint) {
  for (int t = 0; t < kTets; ++t) {
    const double expected = tets.weight(t) * compute_energy_density(GetParam(), tets.motion(t),
                                                                    tets.plastic.col(t), tets.elasticity(t));
    EXPECT_NEAR(lanes.energy(tets.arrays(false), t, t + 1), expected, 1e-12 * expected + 1e-20) << t;
  }
}

TEST_P(LargeStrainLanes, AreAsStiffAsThePointWithTheRestTurned) {
  const double exact = 0.7, kept = 0.2;
  tets.find_stiffness(exact, kept);
  for (int t = 0; t < kTets; ++t) {
    const TetGeometry tet{tets.gradient.middleCols<4>(4 * t), tets.weight(t)};
    const Elasticity e = tets.elasticity(t);
    const Mat9 tangent = compute_positive_tangent(GetParam(), tets.motion(t), tets.plastic.col(t), e);
    const Mat12 expected =
        exact * compute_element_stiffness(tet, tangent) +
        kept * compute_element_stiffness(tet, tets.motion(t).R, make_isotropic_stiffness(e.lambda, e.mu));
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j) {
        const Mat3 block = tets.pairs.col(kPairBlocks * t + find_pair(i, j)).reshaped(3, 3);
        EXPECT_LT((block - expected.block<3, 3>(3 * i, 3 * j)).norm(), 1e-11 * expected.norm()) << t;
      }
  }
}

/// Of a tet, from its pairs' blocks.
Mat12 gather_stiffness(const Tets& tets, int t) {
  Mat12 K = Mat12::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      if (i == j) continue;
      const Mat3 stored = tets.pairs.col(kPairBlocks * t + find_pair(i, j)).reshaped(3, 3);
      const Mat3 block = i < j ? stored : Mat3(stored.transpose());
      K.block<3, 3>(3 * i, 3 * j) = block;
      K.block<3, 3>(3 * i, 3 * i) -= block;
    }
  return K;
}

TEST_P(LargeStrainLanes, StiffnessIsNeverNegative) {
  for (const bool flows : {false, true}) {
    tets.yield.setZero();  // all do
    tets.find_stiffness(1.0, 0.0, flows);
    for (int t = 0; t < kTets; ++t) {
      const Mat12 K = gather_stiffness(tets, t);
      EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm()) << t;
      const Eigen::SelfAdjointEigenSolver<Mat12> modes(K);
      EXPECT_GT(modes.eigenvalues()(0), -1e-11 * modes.eigenvalues()(11)) << t;
    }
  }
}

TEST(HenckyStiffness, OfTetsAtTheirYieldIsThatOfClayThatFlows) {
  // Against the difference of forces before and after a small motion and its radial return. What a tet in
  // tension or under pressure of a few percent of its moduli keeps of it is of that order.
  constexpr double kSmall = 1e-6;
  Tets tets;
  Rng rng(3);
  const auto find_force = [&](int t, const Mat3& F, const Vec6& plastic) {
    return compute_element_force({tets.gradient.middleCols<4>(4 * t), tets.weight(t)}, StrainModel::hencky,
                                 make_motion(StrainModel::hencky, F), plastic, tets.elasticity(t));
  };
  const auto flow = [&](int t, const Mat3& F, Vec6& plastic) {
    const Vec6 strain = compute_strain(F, make_motion(StrainModel::hencky, F).R);
    double released[8] = {};
    flow_by_hencky({strain.data(), plastic.data(), &tets.yield(t)}, 0, 1, released);
    return released[0] > 0.0;
  };
  for (int t = 0; t < kTets; ++t) {  // strained by 4 %, of which 2 % are elastic
    tets.F.middleCols<3>(3 * t) = make_motion_of(rng, 0.04);
    tets.plastic.col(t).setZero();
    tets.yield(t) = 0.02;
    tets.lambda(t) = tets.mu(t);
    Vec6 plastic = tets.plastic.col(t);
    ASSERT_TRUE(flow(t, tets.F.middleCols<3>(3 * t), plastic));
    tets.plastic.col(t) = plastic;
  }
  int flowing = 0;
  for (const bool flows : {true, false}) {
    tets.find_stiffness(1.0, 0.0, flows);
    for (int t = 0; t < kTets; ++t) {
      Mat34 move;
      for (int k = 0; k < 12; ++k) move(k) = rng.uniform(-kSmall, kSmall);
      const Mat3 F = tets.F.middleCols<3>(3 * t);
      const Mat3 moved = F + move * tets.gradient.middleCols<4>(4 * t).transpose();
      Vec6 plastic = tets.plastic.col(t);
      if (flow(t, moved, plastic) != flows) continue;  // it is loaded further, or not
      ++flowing;
      const Mat34 change = find_force(t, moved, plastic) - find_force(t, F, tets.plastic.col(t));
      const Mat34 expected = (gather_stiffness(tets, t) * move.reshaped()).reshaped(3, 4);
      EXPECT_LT((change - expected).norm(), 0.06 * tets.mu(t) * kSmall) << t << flows;
    }
  }
  EXPECT_GT(flowing, kTets / 2);
}

Mat3 find_deviator(const Mat3& a) {
  return a - a.trace() / 3.0 * Mat3::Identity();
}

/// ½ ln FₑFₑᵀ in the frame of R, by matrix functions.
Mat3 find_elastic_strain(const Mat3& stretch, const Vec6& plastic) {
  const Mat3 metric = (-2.0 * from_mandel(plastic)).exp();
  return 0.5 * Mat3(stretch * metric * stretch).log();
}

TEST(HenckyLanes, ElasticStrainIsThatOfMatrixFunctions) {
  const Tets tets;
  each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    TensorField all(6, kTets);
    find_hencky_strain(tets.strain.data(), tets.plastic.data(), begin, end, all.data());
    for (std::ptrdiff_t t = begin; t < end; ++t) {
      const Mat3 expected =
          find_elastic_strain(Mat3::Identity() + from_mandel(tets.strain.col(t)), tets.plastic.col(t));
      const Vec6 e = all.col(t);
      const Mat3 matrix = (Mat3() << e(0), e(5), e(4), e(5), e(1), e(3), e(4), e(3), e(2)).finished();
      EXPECT_LT((matrix - expected).norm(), 1e-13) << t;
    }
  });
}

TEST(HenckyLanes, FlowReturnsToTheYieldAlongTheElasticStrain) {
  Tets tets;
  const TensorField before = tets.plastic;
  int num_flowing = 0;
  each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    double released[kLanes], lost[kLanes];
    FlowArrays points{tets.strain.data(), tets.plastic.data(), tets.yield.data()};
    points.is_balanced_after = false;
    TensorField again = tets.plastic;
    const unsigned flowed = flow_by_hencky(points, begin, end, released);
    flow_by_hencky({tets.strain.data(), again.data(), tets.yield.data()}, begin, end, lost);
    for (std::ptrdiff_t t = begin; t < end; ++t) {
      const Mat3 stretch = Mat3::Identity() + from_mandel(tets.strain.col(t));
      const Mat3 elastic = find_elastic_strain(stretch, before.col(t));
      const double norm = find_deviator(elastic).norm();
      const bool flows = norm > tets.yield(t);
      EXPECT_EQ((flowed >> (t - begin)) & 1U, flows ? 1U : 0U) << t;
      num_flowing += flows;
      if (!flows) {
        EXPECT_EQ((tets.plastic.col(t) - before.col(t)).norm(), 0.0) << t;
        continue;
      }
      const double share = 1.0 - tets.yield(t) / norm;
      const Mat3 after = find_elastic_strain(stretch, tets.plastic.col(t));
      EXPECT_LT((after - (elastic - share * find_deviator(elastic))).norm(), 1e-13) << t;
      EXPECT_LT(std::abs(tets.plastic.col(t).head<3>().sum()), 1e-15) << t;
      EXPECT_NEAR(released[t - begin], norm * norm - tets.yield(t) * tets.yield(t), 1e-12 * norm * norm) << t;
      EXPECT_NEAR(lost[t - begin], 2.0 * tets.yield(t) * (norm - tets.yield(t)), 1e-12 * norm * norm) << t;
    }
  });
  EXPECT_GT(num_flowing, kTets / 4);
  EXPECT_LT(num_flowing, kTets - kTets / 4);
}

TEST(HenckyLanes, FlowTakesTheShareThatItIsGiven) {
  Tets tets;
  tets.yield.setConstant(1e-3);
  const TensorField before = tets.plastic;
  double released[kLanes];
  each_batch([&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    flow_by_hencky({tets.strain.data(), tets.plastic.data(), tets.yield.data(), {0.3, false}}, begin, end,
                   released);
  });
  for (int t = 0; t < kTets; ++t) {
    const Mat3 stretch = Mat3::Identity() + from_mandel(tets.strain.col(t));
    const Mat3 elastic = find_elastic_strain(stretch, before.col(t));
    if (!(find_deviator(elastic).norm() > 1e-3)) continue;
    const Mat3 after = find_elastic_strain(stretch, tets.plastic.col(t));
    EXPECT_LT((after - (elastic - 0.3 * find_deviator(elastic))).norm(), 1e-13) << t;
  }
}

}  // namespace
}  // namespace argil::solid
