// The implicit step on small meshes against closed forms: free fall, a damped oscillator, uniaxial tension, a
// rigid turn.
#include "solid/step_solver.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

SolidParams make_params(linear::SolverKind solver) {
  SolidParams params;
  params.solver.kind = solver;
  params.solver.tolerance = 1e-13;
  return params;
}

class EverySolver : public testing::TestWithParam<linear::SolverKind> {};

TEST_P(EverySolver, FreeFallFollowsBackwardEulerExactly) {
  SolidParams params = make_params(GetParam());
  params.gravity = {0.0, 0.0, -9.81};
  Scene scene(test::make_block(2, 2, 2, Vec3(0.1, 0.1, 0.1)), {}, params, 1e5, 0.3);
  const double h = 0.002;
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(scene.step(h).is_ok());
  // v_n = n g h, x_n = g h² n(n+1)/2
  const Points moved = scene.state.x - scene.mesh.vertices;
  EXPECT_LT((moved.row(2).array() + 9.81 * h * h * 210.0).abs().maxCoeff(), 1e-12);
  EXPECT_LT(moved.topRows<2>().norm(), 1e-12);
}

TEST_P(EverySolver, UniaxialTensionReachesHookesLaw) {
  // Bar under end traction, held without lateral constraint: u = F L/(E A), contraction −ν u/L. P1 is exact
  // for it.
  const double E = 1e6;
  const double nu = 0.35;
  const Vec3 size(0.2, 0.05, 0.05);
  mesh::TetMesh mesh = test::make_block(4, 2, 2, size);
  SolidParams params = make_params(GetParam());
  params.model = StrainModel::linear;
  params.rayleigh_mass = 300.0;
  // The face x = 0 may slide in its plane; with symmetric corner loads on both ends no support is needed at
  // all.
  Scene scene(std::move(mesh), {}, params, E, nu);
  const double stress = 1e3;
  const mesh::Topology topology = mesh::make_topology(scene.mesh);
  for (Eigen::Index f = 0; f < topology.boundary.cols(); ++f) {
    const Vec3 a = scene.mesh.vertices.col(topology.boundary(0, f));
    const Vec3 b = scene.mesh.vertices.col(topology.boundary(1, f));
    const Vec3 c = scene.mesh.vertices.col(topology.boundary(2, f));
    const Vec3 area = 0.5 * (b - a).cross(c - a);
    if (std::abs(area.x()) < 0.9 * area.norm()) continue;
    for (int k = 0; k < 3; ++k) scene.load(0, topology.boundary(k, f)) += stress * area.x() / 3.0;
  }
  for (int k = 0; k < 3000; ++k) ASSERT_TRUE(scene.step(0.01).is_ok());
  for (int t = 0; t < scene.mesh.num_tets(); ++t) {
    EXPECT_NEAR(scene.solid.kinematics.strain()(0, t), stress / E, 1e-9 * stress / E) << t;
    EXPECT_NEAR(scene.solid.kinematics.strain()(1, t), -nu * stress / E, 1e-9 * stress / E) << t;
    EXPECT_NEAR(scene.solid.kinematics.strain().col(t).tail<3>().norm(), 0.0, 1e-9 * stress / E) << t;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver,
                         testing::Values(linear::SolverKind::cholesky, linear::SolverKind::pcg_cholesky,
                                         linear::SolverKind::pcg_jacobi));

TEST(StepSolver, OscillatorLosesAmplitudeAsBackwardEulerPredicts) {
  // One free vertex is a linear oscillator in each eigendirection of its 3×3 stiffness: |z_{n+1}| =
  // |z_n|/√(1+(hω)²), where z = ωu + iv.
  mesh::TetMesh mesh = test::make_block(1, 1, 1, Vec3(1, 1, 1));
  SolidParams params = make_params(linear::SolverKind::cholesky);
  params.model = StrainModel::linear;
  Scene scene(std::move(mesh), {0, 1, 2, 3, 4, 5, 6}, params, 1e5, 0.0);
  // Stiffness of the free vertex from the force of unit displacements (linear model).
  Mat3 K;
  for (int k = 0; k < 3; ++k) {
    Points x = scene.state.x;
    x(k, 7) += 1.0;
    K.col(k) = scene.compute_force(x).col(7);
  }
  const double m = scene.solid.materials.mass()(7);
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(K);
  const Vec3 direction = modes.eigenvectors().col(1);
  const double omega = std::sqrt(modes.eigenvalues()(1) / m);
  const double h = 0.2 / omega;
  scene.state.x.col(7) += 1e-3 * direction;
  ASSERT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  for (int k = 0; k < 25; ++k) ASSERT_TRUE(scene.step(h).is_ok());
  const double u = direction.dot(scene.state.x.col(7) - scene.mesh.vertices.col(7));
  const double v = direction.dot(scene.state.v.col(7));
  const double expected = 1e-3 * omega * std::pow(1.0 + h * h * omega * omega, -12.5);
  EXPECT_NEAR(std::hypot(omega * u, v), expected, 1e-10 * expected);
}

TEST(StepSolver, RigidTurnProducesNoForceInTheCorotationalModelAndTheKnownStrainInTheLinearOne) {
  const double angle = 2.0;
  const Mat3 Q = Eigen::AngleAxisd(angle, Vec3(1, 2, 2) / 3.0).toRotationMatrix();
  for (const StrainModel model : {StrainModel::corotational, StrainModel::linear}) {
    SolidParams params = make_params(linear::SolverKind::cholesky);
    params.model = model;
    params.min_volume_ratio = -10.0;
    Scene scene(test::make_block(2, 1, 1, Vec3(0.2, 0.1, 0.1)), {}, params, 1e5, 0.3);
    const Points x = Q * scene.mesh.vertices;
    ASSERT_TRUE(update_kinematics(scene.solid, scene.region, x, 0).is_ok());
    // sym(Q) − 1 = (cos θ − 1)(1 − a⊗a): norm √2 (1 − cos θ)
    const double expected =
        model == StrainModel::linear ? std::numbers::sqrt2 * (1.0 - std::cos(angle)) : 0.0;
    for (int t = 0; t < scene.mesh.num_tets(); ++t)
      EXPECT_NEAR(scene.solid.kinematics.strain().col(t).norm(), expected, 1e-13);
  }
}

TEST(StepSolver, FreeBodyKeepsItsMomentum) {
  Scene scene(test::make_block(3, 2, 2, Vec3(0.15, 0.1, 0.1)), {},
              make_params(linear::SolverKind::pcg_cholesky), 1e5, 0.3);
  for (Eigen::Index v = 0; v < scene.state.v.cols(); ++v)
    scene.state.v.col(v) =
        Vec3(0.3, -0.1, 0.2) + 0.2 * std::sin(7.0 * static_cast<double>(v)) * Vec3(1, 1, -1);
  const Vec3 before = scene.state.v * scene.solid.materials.mass();
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(scene.step(1e-3).is_ok());
  const Vec3 after = scene.state.v * scene.solid.materials.mass();
  EXPECT_LT((after - before).norm(), 1e-11 * before.norm());
}

TEST(StepSolver, LumpedMassIsDensityTimesVolume) {
  Scene scene(test::make_block(3, 2, 2, Vec3(0.3, 0.2, 0.1)), {}, make_params(linear::SolverKind::cholesky),
              1e5, 0.3);
  EXPECT_NEAR(scene.solid.materials.mass().sum(), 1500.0 * 0.3 * 0.2 * 0.1, 1e-12);
}

TEST(StepSolver, QuadraticMassIsLumpedInProportionToTheConsistentDiagonal) {
  // ∫Lᵃ dV = 6V a!/(a+3)! and ∫L₁²L₂² dV = 24V/7!, with N = L(2L − 1) at corners, 4 L₁L₂ between them.
  const double corner = 4.0 * 6.0 * 24.0 / 5040.0 - 4.0 * 6.0 * 6.0 / 720.0 + 6.0 * 2.0 / 120.0;  // ∫N²/V
  const double middle = 16.0 * 24.0 / 5040.0;
  mesh::TetMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1;  // V = 1
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  SolidParams params = make_params(linear::SolverKind::cholesky);
  params.element = ElementKind::p2;
  const Scene scene(mesh, {}, params, 1e5, 0.3);
  const double scale = 1500.0 / (4.0 * corner + 6.0 * middle);
  for (int n = 0; n < 10; ++n)
    EXPECT_NEAR(scene.solid.materials.mass()(n), scale * (n < 4 ? corner : middle), 1e-10) << n;
}

TEST(StepSolver, PlasticStrainIsTheStressFreeShape) {
  // A body whose total strain equals its plastic strain is at rest in the deformed place.
  Scene scene(test::make_block(2, 2, 2, Vec3(0.1, 0.1, 0.1)), {}, make_params(linear::SolverKind::cholesky),
              1e5, 0.3);
  const Mat3 stretch = Vec3(1.1, 0.95, 1.0).asDiagonal();
  scene.state.x = stretch * scene.mesh.vertices;
  ASSERT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  scene.state.plastic_strain = scene.solid.kinematics.strain();
  ASSERT_TRUE(scene.step(1e-3).is_ok());
  EXPECT_LT(scene.state.v.norm(), 1e-12);
}

TEST(StepSolver, InvertedTetStopsTheStepAndIsNamed) {
  Scene scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {}, make_params(linear::SolverKind::cholesky), 1e5,
              0.3);
  Points x = scene.mesh.vertices;
  x.col(7) = Vec3(-1, -1, -1);
  const StepStatus status = update_kinematics(scene.solid, scene.region, x, 42);
  ASSERT_FALSE(status.is_ok());
  EXPECT_EQ(status.failure().tick, 42);
  EXPECT_GE(status.failure().element, 0);
  EXPECT_LE(status.failure().value, 0.0);
}

TEST(StepSolver, NanInThePositionsStopsTheStep) {
  Scene scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {}, make_params(linear::SolverKind::cholesky), 1e5,
              0.3);
  Points x = scene.mesh.vertices;
  x(1, 3) = std::nan("");
  EXPECT_FALSE(update_kinematics(scene.solid, scene.region, x, 0).is_ok());
}

TEST(StepSolver, ContactStiffnessActsAsASpringBetweenBodyAndTool) {
  // One free vertex of mass m, spring k at velocity v along n: (m + h²k) v' = m v when nothing else acts (E
  // tiny).
  mesh::TetMesh mesh = test::make_block(1, 1, 1, Vec3(1, 1, 1));
  Scene scene(std::move(mesh), {0, 1, 2, 3, 4, 5, 6}, make_params(linear::SolverKind::cholesky), 1e-9, 0.0);
  const double h = 0.01;
  const double m = scene.solid.materials.mass()(7);
  const double k = 3.0 * m / (h * h);
  scene.state.v.col(7) = Vec3(0, 0, -2);
  const PointStiffness contact{{7, -1, -1}, {1.0, 0.0, 0.0}, Vec3::UnitZ(), k};
  ASSERT_TRUE(scene.solve(h, std::span(&contact, 1)).is_ok());
  EXPECT_NEAR(scene.state.v(2, 7), -0.5, 1e-9);
}

TEST(StepSolver, EqualBitsOnAnyNumberOfThreads) {
  Points first;
  for (const int threads : {1, 2, 4, 7}) {
    SolidParams params = make_params(linear::SolverKind::pcg_cholesky);
    params.solver.tolerance = 1e-6;
    Scene scene(test::make_block(4, 3, 3, Vec3(0.2, 0.1, 0.1)), {0, 1, 2}, params, 1e5, 0.4, threads);
    scene.load.col(60) = Vec3(0.2, -0.5, 1.0);
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(scene.step(1e-3).is_ok());
    if (threads == 1) first = scene.state.x;
    EXPECT_TRUE((scene.state.x.array() == first.array()).all()) << threads;
  }
}

}  // namespace
}  // namespace argil::solid
