// One tet: the polar decomposition against its definition, force and stiffness against affine closed forms
// and against the derivative of the energy.
#include "solid/element.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include "base/rng.h"

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

}  // namespace
}  // namespace argil::solid
