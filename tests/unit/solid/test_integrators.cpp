// Integrators against the closed form of an oscillator, and on a large motion against a fine reference.
#include <Eigen/Eigenvalues>

#include <numbers>

#include "support/solid_scene.h"

namespace argil::solid {
namespace {

using test::Scene;

constexpr Integrator kIntegrators[] = {Integrator::backward_euler, Integrator::bdf2, Integrator::newmark,
                                       Integrator::symplectic_euler};

int design_order(Integrator integrator) {
  return integrator == Integrator::bdf2 || integrator == Integrator::newmark ? 2 : 1;
}

/// One free node of a cube: a linear oscillator along each eigenvector of its 3×3 stiffness.
struct Oscillator {
  Scene scene;
  Vec3 direction = Vec3::Zero();
  double omega = 0.0;

  static SolidParams make_params(SolidParams params) {
    params.model = StrainModel::linear;
    params.solver.kind = linear::SolverKind::cholesky;
    return params;
  }
  explicit Oscillator(const SolidParams& params)
      : scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {0, 1, 2, 3, 4, 5, 6}, make_params(params), 1e5,
              0.2) {
    Mat3 K;
    for (int k = 0; k < 3; ++k) {
      Points x = scene.state.x;
      x(k, 7) += 0.5;
      K.col(k) = 2.0 * scene.compute_force(x).col(7);
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> modes(0.5 * (K + K.transpose()));
    direction = modes.eigenvectors().col(1);
    omega = std::sqrt(modes.eigenvalues()(1) / scene.solid.materials.mass()(7));
    EXPECT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  }
  double u() const { return direction.dot(scene.displacement().col(7)); }
  double v() const { return direction.dot(scene.state.v.col(7)); }
  void start(double u0, double v0) {
    scene.state.x.col(7) += u0 * direction;
    scene.state.v.col(7) = v0 * direction;
    EXPECT_TRUE(update_kinematics(scene.solid, scene.region, scene.state.x, 0).is_ok());
  }
};

/// u and v/ω of m ü + (a m + b k) u̇ + k u = 0 from u(0) = u₀, u̇(0) = v₀, under-damped.
std::pair<double, double> solve_oscillator(double omega, double a, double b, double u0, double v0, double t) {
  const double decay = 0.5 * (a + b * omega * omega);
  const double turn = std::sqrt(omega * omega - decay * decay);
  const double c = std::cos(turn * t);
  const double s = std::sin(turn * t);
  const double sine = (v0 + decay * u0) / turn;
  const double e = std::exp(-decay * t);
  return {e * (u0 * c + sine * s), e * (v0 * c - (turn * u0 + decay * sine) * s) / omega};
}

/// Slope of log error over log step by least squares.
double fit_order(const std::vector<double>& errors) {
  double sxy = 0.0;
  double sxx = 0.0;
  const double middle = 0.5 * static_cast<double>(errors.size() - 1);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double x = static_cast<double>(i) - middle;  // steps halve
    sxy += x * -std::log2(errors[i]);
    sxx += x * x;
  }
  return sxy / sxx;
}

TEST(Integrator, ConvergesToTheDampedOscillationAtItsOrder) {
  for (const Integrator integrator : kIntegrators)
    for (const Iteration iteration : {Iteration::one, Iteration::newton}) {
      std::vector<double> errors;
      for (int steps = 100; steps <= 800; steps *= 2) {
        SolidParams params;
        params.integrator = integrator;
        params.iteration = iteration;
        const double omega = Oscillator(params).omega;
        params.rayleigh_mass = 0.05 * omega;
        params.rayleigh_stiffness = 0.03 / omega;
        Oscillator body(params);
        body.start(1e-3, 5e-4 * omega);
        const double end = 1.3 * 2.0 * std::numbers::pi / omega;
        for (int k = 0; k < steps; ++k) ASSERT_TRUE(body.scene.step(end / steps).is_ok());
        const auto [u, v] =
            solve_oscillator(omega, params.rayleigh_mass, params.rayleigh_stiffness, 1e-3, 5e-4 * omega, end);
        errors.push_back(std::hypot(body.u() - u, body.v() / omega - v));
      }
      const double order = fit_order(errors);
      EXPECT_GT(order, design_order(integrator) - 0.15) << static_cast<int>(integrator);
      EXPECT_LT(order, design_order(integrator) + 0.3) << static_cast<int>(integrator);
    }
}

TEST(Integrator, NewmarkKeepsTheEnergyOfALinearBody) {
  SolidParams params;
  params.integrator = Integrator::newmark;
  Oscillator body(params);
  body.start(1e-3, 0.0);
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(body.scene.step(0.7 / body.omega).is_ok());
  EXPECT_NEAR(std::hypot(body.u(), body.v() / body.omega), 1e-3, 1e-13);
}

TEST(Integrator, RayleighDampingDecaysAModeAtItsRate) {
  // a/2 + b ω²/2 per second: the amplitude after ten periods, by a second-order rule with 400 steps a period.
  for (const Integrator integrator : {Integrator::bdf2, Integrator::newmark}) {
    SolidParams params;
    params.integrator = integrator;
    const double omega = Oscillator(params).omega;
    params.rayleigh_mass = 0.02 * omega;
    params.rayleigh_stiffness = 0.01 / omega;
    Oscillator body(params);
    body.start(1e-3, 0.0);
    const double h = 2.0 * std::numbers::pi / omega / 400.0;
    for (int k = 0; k < 4000; ++k) ASSERT_TRUE(body.scene.step(h).is_ok());
    const double amplitude = std::hypot(body.u(), body.v() / omega + 0.015 * body.u());
    EXPECT_NEAR(std::log(1e-3 / amplitude), 0.015 * 20.0 * std::numbers::pi, 2e-3);
  }
}

TEST(Integrator, ExplicitStepIsStableBelowTwoOverTheLargestFrequencyAndNotAbove) {
  for (const ElementKind element : {ElementKind::p1, ElementKind::p1_nodal, ElementKind::p2}) {
    SolidParams params;
    params.model = StrainModel::linear;
    params.element = element;
    params.integrator = Integrator::symplectic_euler;
    const auto make = [&] {
      return Scene(test::make_irregular_block(2, 1, 1, Vec3(0.2, 0.1, 0.1)), {0, 3}, params, 1e5, 0.45);
    };
    Scene scene = make();
    // K by unit displacements, ω² the eigenvalues of M^-½ K M^-½ over the free nodes.
    std::vector<int> free;
    for (int n = 0; n < scene.num_nodes(); ++n)
      if (scene.solid.model.constraints.is_free(n)) free.push_back(n);
    const auto size = static_cast<Eigen::Index>(3 * free.size());
    Eigen::MatrixXd A(size, size);
    for (Eigen::Index j = 0; j < size; ++j) {
      Points x = scene.rest();
      x(j % 3, free[static_cast<std::size_t>(j / 3)]) += 1e-4;
      const Points f = 1e4 * scene.compute_force(x);
      for (Eigen::Index i = 0; i < size; ++i)
        A(i, j) = f(i % 3, free[static_cast<std::size_t>(i / 3)]) /
                  std::sqrt(scene.solid.materials.mass()(free[static_cast<std::size_t>(i / 3)]) *
                            scene.solid.materials.mass()(free[static_cast<std::size_t>(j / 3)]));
    }
    const double omega = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues()(size - 1));
    for (const double share : {0.995, 1.005}) {
      Scene body = make();
      Rng rng(1);
      for (const int n : free)
        body.state.v.col(n) = 1e-5 * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
      const double start = body.state.v.norm();
      double largest = 0.0;
      for (int k = 0; k < 600 && largest < 1e3 * start; ++k) {
        if (!body.step(share * 2.0 / omega).is_ok()) largest = 1e300;
        largest = std::max(largest, body.state.v.norm());
      }
      if (share < 1.0)
        EXPECT_LT(largest, 30.0 * start) << static_cast<int>(element);
      else
        EXPECT_GT(largest, 1e3 * start) << static_cast<int>(element);
    }
  }
}

/// Positions and, at the scale of a swing, velocities of a bar that is thrown aside.
Points swing(SolidParams params, int steps) {
  params.solver.kind = linear::SolverKind::cholesky;
  params.newton_tolerance = 1e-11;
  Scene scene(test::make_block(3, 1, 1, Vec3(0.3, 0.1, 0.1)), {0, 4, 8, 12}, params, 3e4, 0.3);
  for (int n = 0; n < scene.num_nodes(); ++n) {
    const double s = scene.rest()(0, n);
    scene.state.v.col(n) = 3.0 * s / 0.3 * Vec3(-0.3, 0.5, 1.0);
  }
  for (int k = 0; k < steps; ++k) {
    const StepStatus status = scene.step(0.05 / steps);
    EXPECT_TRUE(status.is_ok()) << status.failure().quantity << ' ' << status.failure().value;
  }
  Points result(3, 2 * scene.num_nodes());
  result << scene.state.x, 0.01 * scene.state.v;
  return result;
}

TEST(Integrator, OfALargeMotionConvergesAtItsOrder) {
  for (const StrainModel model : {StrainModel::corotational, StrainModel::neo_hookean}) {
    SolidParams params;
    params.model = model;
    params.iteration = Iteration::newton;
    params.integrator = Integrator::newmark;
    const Points reference = swing(params, 3200);
    for (const Integrator integrator : kIntegrators) {
      params.integrator = integrator;
      std::vector<double> errors;
      for (const int steps : {100, 200, 400}) errors.push_back((swing(params, steps) - reference).norm());
      const double order = fit_order(errors);
      EXPECT_GT(order, design_order(integrator) - 0.2) << static_cast<int>(integrator);
      EXPECT_LT(order, design_order(integrator) + 0.3) << static_cast<int>(integrator);
    }
  }
}

TEST(PrescribedNode, GoesAtTheSpeedOfItsRampInEveryIntegrator) {
  for (const Integrator integrator : kIntegrators) {
    SolidParams params;
    params.integrator = integrator;
    params.solver.kind = linear::SolverKind::cholesky;
    Support pull = test::hold_nodes({7});
    pull.displacement = Vec3(0.02, 0, 0);
    pull.ramp_end = 0.1;
    Scene scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {test::hold_nodes({0, 1, 2, 3}), pull}, params, 1e5,
                0.2);
    for (int k = 1; k <= 10; ++k) {
      ASSERT_TRUE(scene.step(0.005).is_ok());
      EXPECT_NEAR(scene.displacement()(0, 7), 0.001 * k, 1e-15);
      EXPECT_NEAR(scene.state.v(0, 7), 0.2, 1e-11) << static_cast<int>(integrator) << k;
    }
  }
}

TEST(ContactForce, ThatActedIsTheChangeOfMomentum) {
  // One free node of a body without stiffness: M (v' − v) = h f.
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::newmark}) {
    SolidParams params;
    params.integrator = integrator;
    params.solver.kind = linear::SolverKind::cholesky;
    Scene scene(test::make_block(1, 1, 1, Vec3(1, 1, 1)), {0, 1, 2, 3, 4, 5, 6}, params, 1e-9, 0.0);
    const double h = 0.01;
    const double m = scene.solid.materials.mass()(7);
    scene.state.v.col(7) = Vec3(0, 0, -2);
    scene.load(2, 7) = 30.0 * m;
    Points force = scene.load;
    const PointStiffness contact{{7, -1, -1}, {1.0, 0.0, 0.0}, Vec3::UnitZ(), 0.8 * m / (h * h)};
    ASSERT_TRUE(scene.solve(h, std::span(&contact, 1)).is_ok());
    apply_contact_stiffness(scene.solid, std::span(&contact, 1), force);
    EXPECT_NEAR(h * force(2, 7), m * (scene.state.v(2, 7) + 2.0), 1e-9 * m) << static_cast<int>(integrator);
  }
}

}  // namespace
}  // namespace argil::solid
