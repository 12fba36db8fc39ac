// One tet: the polar decomposition against its definition, force and stiffness against affine closed forms
// and against the derivative of the energy.
#include "solid/element.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "base/rng.h"
#include "material/plasticity.h"

namespace argil::solid {
namespace {

Mat3 make_random_matrix(Rng& rng, double scale) {
  Mat3 a;
  for (int i = 0; i < 9; ++i) a(i) = rng.uniform(-scale, scale);
  return a;
}

Mat3 make_random_rotation(Rng& rng) {
  return Quat(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1))
      .normalized()
      .toRotationMatrix();
}

Mat34 make_random_tet(Rng& rng) {
  Mat34 rest;
  rest << 0, 1, 0.1, 0.2, 0, 0.1, 1.2, 0.3, 0, -0.1, 0.2, 0.9;
  for (int i = 0; i < 12; ++i) rest(i) += rng.uniform(-0.1, 0.1);
  return rest;
}

TEST(ComputeRotation, ReturnsTheFactorsFromWhichFWasBuilt) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 R = make_random_rotation(rng);
    const Mat3 Q = make_random_rotation(rng);
    const Vec3 stretch(rng.uniform(0.05, 3.0), rng.uniform(0.05, 3.0), rng.uniform(0.05, 3.0));
    const Mat3 S = Q * stretch.asDiagonal() * Q.transpose();
    EXPECT_LT((compute_rotation(R * S) - R).norm(), 1e-13) << i;  // rounding times condition number 60
  }
}

TEST(ComputeRotation, OfAnInvertedMatrixTurnsTheSmallestStretch) {
  const Mat3 F = Vec3(2.0, 1.0, -0.1).asDiagonal();
  EXPECT_LT((compute_rotation(F) - Mat3::Identity()).norm(), 1e-14);
}

TEST(ComputeRotation, OfAnyMatrixIsARotation) {
  Rng rng(2);
  for (int i = 0; i < 1000; ++i) {
    Mat3 F = make_random_matrix(rng, 1.0);
    if (i % 3 == 0) F.col(2) = F.col(0) + 1e-9 * F.col(1);  // flat
    const Mat3 R = compute_rotation(F);
    EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-13);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-13);
  }
}

TEST(ComputeStrain, IsObjective) {
  Rng rng(3);
  const Mat3 F = Mat3::Identity() + make_random_matrix(rng, 0.2);
  const Mat3 Q = make_random_rotation(rng);
  EXPECT_LT((compute_strain(F, compute_rotation(F)) - compute_strain(Q * F, compute_rotation(Q * F))).norm(),
            1e-14);
}

TEST(ComputeElementForce, OfUniaxialStressIsStressTimesAreaOverThree) {
  // Unit right tet stretched along x by e and contracted sideways by ν e: σ_xx = E e, all other stresses
  // zero. The face x = 0 has area ½; its three corners share the force −σ_xx/2.
  const double E = 2e5;
  const double nu = 0.3;
  const double e = 1e-3;
  Mat34 rest;
  rest << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  const TetGeometry tet = make_tet_geometry(rest);
  const Mat3 F = Vec3(1.0 + e, 1.0 - nu * e, 1.0 - nu * e).asDiagonal();
  const Elasticity elasticity{E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
  const Mat34 f = compute_element_force(tet, StrainModel::corotational,
                                        make_motion(StrainModel::corotational, F), Vec6::Zero(), elasticity);
  EXPECT_NEAR(f(0, 1), E * e / 6.0, 1e-12 * E * e);
  EXPECT_NEAR(f(0, 0), -E * e / 6.0, 1e-12 * E * e);
  EXPECT_LT(f.bottomRows<2>().norm(), 1e-12 * E * e);
}

struct LawCase {
  StrainModel model;
  bool is_anisotropic;
  bool is_plastic;
};

class EveryLaw : public testing::TestWithParam<LawCase> {
 protected:
  EveryLaw() {
    C = make_isotropic_stiffness(3.0, 2.0);
    C(0, 0) += 1.5;
    C(3, 3) += 0.7;
    e.lambda = 3.0;
    e.mu = 2.0;
    if (GetParam().is_anisotropic) e.C = &C;
    if (GetParam().is_plastic) plastic = to_mandel(make_symmetric(0.1));
    F = make_random_rotation(rng) * (Mat3::Identity() + make_symmetric(0.25));
  }
  Mat3 make_symmetric(double scale) {
    const Mat3 a = make_random_matrix(rng, scale);
    return 0.5 * (a + a.transpose());
  }
  Mat3 piola(const Mat3& at) const {
    return compute_piola(GetParam().model, make_motion(GetParam().model, at), plastic, e);
  }
  double energy(const Mat3& at) const {
    return compute_energy_density(GetParam().model, make_motion(GetParam().model, at), plastic, e);
  }

  Rng rng{4};
  Mat6 C;
  Elasticity e;
  Vec6 plastic = Vec6::Zero();
  Mat3 F;
};

TEST_P(EveryLaw, StressIsTheDerivativeOfTheEnergy) {
  const Mat3 P = piola(F);
  for (int i = 0; i < 9; ++i) {
    const double d = 1e-5;  // error d² and rounding ε/d of the energy: both some 1e-10
    Mat3 plus = F;
    Mat3 minus = F;
    plus(i) += d;
    minus(i) -= d;
    EXPECT_NEAR(P(i), (energy(plus) - energy(minus)) / (2 * d), 1e-8) << i;
  }
}

TEST_P(EveryLaw, StressTurnsWithTheBodyAndBalancesMoments) {
  if (GetParam().model == StrainModel::linear) GTEST_SKIP() << "the linear model is not objective";
  const Mat3 Q = make_random_rotation(rng);
  EXPECT_LT((piola(Q * F) - Q * piola(F)).norm(), 1e-13);
  const Mat3 kirchhoff = piola(F) * F.transpose();
  EXPECT_LT((kirchhoff - kirchhoff.transpose()).norm(), 1e-13);
}

TEST_P(EveryLaw, TangentIsTheDerivativeOfTheStress) {
  const StrainModel model = GetParam().model;
  e.excess_bulk = 5.0;  // held fast: its own change has another place in the matrix
  e.volume_change = 0.07;
  const Mat9 A = compute_tangent(model, make_motion(model, F), plastic, e);
  for (int i = 0; i < 9; ++i) {
    const double d = 1e-6;
    Mat3 plus = F;
    Mat3 minus = F;
    plus(i) += d;
    minus(i) -= d;
    EXPECT_LT((A.col(i) - ((piola(plus) - piola(minus)) / (2 * d)).reshaped()).norm(), 1e-7) << i;
  }
}

TEST_P(EveryLaw, TangentHasNoNegativeModeUnderStrongCompression) {
  F = make_random_rotation(rng) * Vec3(0.3, 0.4, 0.5).asDiagonal();
  const Mat9 A =
      make_positive(compute_tangent(GetParam().model, make_motion(GetParam().model, F), plastic, e));
  EXPECT_LT((A - A.transpose()).norm(), 1e-12 * A.norm());
  EXPECT_GT(A.selfadjointView<Eigen::Lower>().eigenvalues()(0), -1e-8 * A.norm());
}

TEST_P(EveryLaw, SmallStrainIsHookesLaw) {
  if (GetParam().is_plastic) GTEST_SKIP() << "not about the rest state";
  const Mat3 strain = make_symmetric(1e-7);
  const Mat3 expected = from_mandel(compute_stress(e, to_mandel(strain)));
  EXPECT_LT((piola(Mat3::Identity() + strain) - expected).norm(), 1e-5 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw,
                         testing::Values(LawCase{StrainModel::linear, false, false},
                                         LawCase{StrainModel::linear, true, true},
                                         LawCase{StrainModel::corotational, false, false},
                                         LawCase{StrainModel::corotational, true, false},
                                         LawCase{StrainModel::corotational, false, true},
                                         LawCase{StrainModel::corotational, true, true},
                                         LawCase{StrainModel::neo_hookean, false, false},
                                         LawCase{StrainModel::neo_hookean, false, true}));

TEST(ComputeElementStiffness, IsTheDerivativeOfTheForceForAKeptRotation) {
  Rng rng(6);
  const TetGeometry tet = make_tet_geometry(make_random_tet(rng));
  const Mat3 R = make_random_rotation(rng);
  Mat6 C = make_isotropic_stiffness(3.0, 2.0);
  C(0, 0) += 1.5;
  const Mat12 K = compute_element_stiffness(tet, R, C);
  for (int i = 0; i < 12; ++i) {
    Mat34 u = Mat34::Zero();
    u(i) = 1.0;
    const Mat3 turned = R.transpose() * u * tet.gradient.transpose();
    const Vec6 strain = to_mandel(0.5 * (turned + turned.transpose()));
    const Mat34 f = tet.volume * R * from_mandel(C * strain) * tet.gradient;
    EXPECT_LT((K.col(i) - f.reshaped()).norm(), 1e-13 * K.norm()) << i;
  }
}

TEST(ComputeElementStiffness, HasTheSixRigidModesAndNoNegativeOnes) {
  Rng rng(5);
  const TetGeometry tet = make_tet_geometry(make_random_tet(rng));
  const Mat12 K =
      compute_element_stiffness(tet, make_random_rotation(rng), make_isotropic_stiffness(3.0, 2.0));
  const Eigen::VectorXd eigen = K.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_LT(eigen.head<6>().cwiseAbs().maxCoeff(), 1e-13 * eigen(11));
  EXPECT_GT(eigen(6), 1e-3 * eigen(11));
}

Vec6 make_deviator(Vec6 e) {
  e.head<3>().array() -= e.head<3>().sum() / 3.0;
  return e;
}

TEST(NeoHookean, PlasticStrainWithoutTraceTakesNoVolumeHoweverLarge) {
  // The body at its rest shape after ε_p: det Fₑ = 1/det F_p = exp(−tr ε_p).
  Rng rng(3, "plastic");
  const Mat3 a = make_random_matrix(rng, 0.3);
  const Vec6 e = to_mandel(0.5 * (a + a.transpose()));
  const PointMotion rest = make_motion(StrainModel::neo_hookean, Mat3::Identity());
  EXPECT_NEAR(compute_volume_change(StrainModel::neo_hookean, rest, make_deviator(e)), 0.0, 1e-15);
  EXPECT_NEAR(compute_volume_change(StrainModel::neo_hookean, rest, e), std::exp(-e.head<3>().sum()) - 1.0,
              1e-15);
}

TEST(FlowDrive, IsTheEnergysSlopeAlongPlasticStrainWithoutTrace) {
  // −∂W/∂ε_p : d = 2μ q : d for every d without trace, by central differences; also where F_p is large.
  Rng rng(9, "drive");
  const Elasticity e{30.0, 2.0};
  for (const StrainModel model : {StrainModel::linear, StrainModel::corotational, StrainModel::neo_hookean})
    for (const double size : {0.05, 0.3}) {
      const Mat3 F = make_random_rotation(rng) * (Mat3::Identity() + make_random_matrix(rng, size));
      const PointMotion motion = make_motion(model, F);
      const Mat3 a = make_random_matrix(rng, size);
      const Vec6 plastic = to_mandel(0.5 * (a + a.transpose()));
      const Vec6 q = compute_flow_drive(model, motion, plastic, e, 2.0 * e.mu);
      const Mat3 b = make_random_matrix(rng, 1.0);
      const Vec6 d = make_deviator(to_mandel(0.5 * (b + b.transpose())));
      const auto energy = [&](double s) { return compute_energy_density(model, motion, plastic + s * d, e); };
      EXPECT_NEAR(-(energy(1e-5) - energy(-1e-5)) / 2e-5, 2.0 * e.mu * q.dot(d), 1e-7 * (1.0 + energy(0.0)));
      EXPECT_NEAR(q.head<3>().sum(), 0.0, 1e-14 * (1.0 + q.norm()));
    }
}

}  // namespace
}  // namespace argil::solid
