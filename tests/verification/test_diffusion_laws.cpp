// Diffusion in time and in three dimensions: the semi-discrete system's matrix exponential, a point source, a
// diffusivity that follows the saturation, and implicit steps of any length.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/rng.h"
#include "shapes/shapes.h"
#include "support/block_mesh.h"
#include "support/mirrored_mesh.h"
#include "support/shaken_block.h"
#include "water/water.h"

namespace argil::water {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kD = 2e-6;  // [m²/s]
constexpr DiffusionScheme kSchemes[] = {DiffusionScheme::explicit_euler, DiffusionScheme::implicit_euler};

WaterParams make_params(DiffusionScheme scheme, FluxForm flux, double exponent = 0.0) {
  WaterParams params;
  params.diffusivity = kD;
  params.diffusivity_exponent = exponent;
  params.scheme = scheme;
  params.flux = flux;
  return params;
}

Points compute_centroids(const mesh::TetMesh& mesh) {
  Points centres = Points::Zero(3, mesh.num_tets());
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (int i = 0; i < 4; ++i) centres.col(t) += 0.25 * mesh.vertices.col(mesh.tets(i, t));
  return centres;
}

Field diffuse(const mesh::TetMesh& mesh, const WaterParams& params, const Field& start, double time,
              int steps) {
  const mesh::Topology topology = mesh::make_topology(mesh);
  PoreWater water(mesh, topology, params, start);
  for (int i = 0; i < steps; ++i) water.diffuse(time / steps);
  EXPECT_LT(std::abs(water.ledger_error()), 1e-14);
  return water.saturation();
}

/// Slope of ln(error) against ln(size).
double fit_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(sizes.size()), 2);
  Field b(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    A.row(i) << std::log(sizes[static_cast<std::size_t>(i)]), 1.0;
    b(i) = std::log(errors[static_cast<std::size_t>(i)]);
  }
  return A.colPivHouseholderQr().solve(b)(0);
}

TEST(Diffusion, TendsToTheMatrixExponentialOfItsMesh) {
  // V dS/dt = −L S. With Y = V^½ S, dY/dt = −M Y, M = V^−½ L V^−½ symmetric: S(T) = V^−½ e^{−MT} V^½ S(0).
  // Euler's error is a power series in the step; Romberg's table removes its first four terms.
  const mesh::TetMesh mesh = test::make_shaken_block(2);
  const mesh::Topology topology = mesh::make_topology(mesh);
  const Stencil stencil = make_stencil(mesh, topology, kD, FluxForm::two_point);
  const Eigen::Index m = mesh.num_tets();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(m, m);
  for (int t = 0; t < m; ++t)
    for (int c = 0; c < 4; ++c) {
      const int other = stencil.neighbours(c, t);
      if (other < 0) continue;
      M(t, t) += stencil.conductance(c, t) / stencil.volume(t);
      M(t, other) -= stencil.conductance(c, t) / std::sqrt(stencil.volume(t) * stencil.volume(other));
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(M);
  Rng rng(5, "start");
  Field start(m);
  for (double& s : start) s = rng.uniform(0.1, 0.9);
  const double time = 30.0 * stencil.monotone_step;
  const Field root = stencil.volume.cwiseSqrt();
  const Field decay = (-time * eigen.eigenvalues().array()).exp();
  const Field exact =
      (eigen.eigenvectors() * decay.cwiseProduct(eigen.eigenvectors().transpose() * root.cwiseProduct(start)))
          .cwiseQuotient(root);
  EXPECT_GT((exact - start).cwiseAbs().maxCoeff(), 0.2);
  for (const DiffusionScheme scheme : kSchemes) {
    std::vector<Field> table;
    std::vector<double> steps, errors;
    for (int level = 0; level < 5; ++level) {
      const int n = 64 << level;
      Field row = diffuse(mesh, make_params(scheme, FluxForm::two_point), start, time, n);
      steps.push_back(time / n);
      errors.push_back((row - exact).cwiseAbs().maxCoeff());
      std::printf("step %.3e s  error %.3e\n", steps.back(), errors.back());
      for (std::size_t k = 0; k < table.size(); ++k) {
        const double power = std::pow(2.0, static_cast<double>(k + 1));
        const Field better = (power * row - table[k]) / (power - 1.0);
        table[k] = row;
        row = better;
      }
      table.push_back(row);
    }
    EXPECT_NEAR(fit_order(steps, errors), 1.0, 0.15);
    EXPECT_LT((table.back() - exact).cwiseAbs().maxCoeff(), 1e-9);  // (λ h)⁵ of the fifth column
  }
}

/// Water that starts in the tets round the middle of a sealed cube: largest error against the series of the
/// point source, S = M Π_k (1 + 2 Σ_j cos(jπ/2) cos(jπ x_k/L) e^{−D(jπ/L)²t}), over its peak.
double compute_point_source_error(const mesh::TetMesh& mesh, FluxForm flux) {
  const double L = 0.1;
  const double time = 0.012 * L * L / kD;  // √(4Dt) = 0.22 L
  const Vec3 middle = Vec3::Constant(0.5 * L);
  const Field volume = mesh::compute_volumes(mesh.vertices, mesh.tets);
  Field start = Field::Zero(mesh.num_tets());
  for (int t = 0; t < mesh.num_tets(); ++t)
    for (int i = 0; i < 4; ++i)
      if ((mesh.vertices.col(mesh.tets(i, t)) - middle).norm() < 1e-9) start(t) = 0.9;
  const double amount = volume.dot(start) / (L * L * L);
  const Field S = diffuse(mesh, make_params(DiffusionScheme::explicit_euler, flux), start, time, 1);
  const Points centres = compute_centroids(mesh);
  double worst = 0.0, peak = 0.0;
  for (int t = 0; t < mesh.num_tets(); ++t) {
    double exact = amount;
    for (int k = 0; k < 3; ++k) {
      double sum = 1.0;
      for (int j = 2; j < 60; j += 2) {
        const double q = j * kPi / L;
        sum += 2.0 * std::cos(0.5 * j * kPi) * std::cos(q * centres(k, t)) * std::exp(-kD * q * q * time);
      }
      exact *= sum;
    }
    worst = std::max(worst, std::abs(S(t) - exact));
    peak = std::max(peak, exact);
  }
  return worst / peak;
}

TEST(Diffusion, OfAPointSourceConvergesWithOrderTwoWhereTheFluxIsConsistent) {
  const auto cube = Vec3(0.1, 0.1, 0.1);
  std::vector<double> sizes, orthogonal[2], kuhn[2];
  for (const int n : {8, 12, 16, 24}) {
    sizes.push_back(1.0 / n);
    for (const FluxForm flux : {FluxForm::two_point, FluxForm::corrected}) {
      const auto f = static_cast<std::size_t>(flux == FluxForm::corrected);
      orthogonal[f].push_back(compute_point_source_error(test::make_mirrored_block(n, n, n, cube), flux));
      kuhn[f].push_back(compute_point_source_error(test::make_block(n, n, n, cube), flux));
    }
    std::printf(
        "%2d cubes an edge: orthogonal two_point %.4f corrected %.4f; Kuhn two_point %.4f corrected "
        "%.4f of the peak\n",
        n, orthogonal[0].back(), orthogonal[1].back(), kuhn[0].back(), kuhn[1].back());
  }
  // Order between the two finest. Coarser ones lie below it: the source is as wide as a cell, and that width
  // over √(4Dt) must be small (1.7, 1.8, 1.9 on orthogonal meshes). Where centroids are not opposite each
  // other: 1.5, 1.7, 1.8.
  const auto finest = [&](const std::vector<double>& errors) {
    return std::log(errors[2] / errors[3]) / std::log(sizes[2] / sizes[3]);
  };
  for (const auto& [errors, least] :
       {std::pair(orthogonal[0], 1.85), std::pair(orthogonal[1], 1.85), std::pair(kuhn[1], 1.75)}) {
    EXPECT_GT(finest(errors), least);
    EXPECT_LT(finest(errors), 2.3);
    EXPECT_TRUE(std::is_sorted(errors.rbegin(), errors.rend()));
  }
  // The two-point flux on tets whose centroids are not opposite each other: refinement does not help.
  EXPECT_LT(fit_order(sizes, kuhn[0]), 0.5);
  EXPECT_GT(kuhn[0].back(), 0.05);
}

/// ∂S/∂t = ∂/∂x(D₀ e^{βS} ∂S/∂x) in a sealed bar from ½ + 0.4 cos(πx/L): finite differences with the mean of
/// the two cells' D, classical Runge–Kutta.
Field integrate_bar(int cells, double L, double beta, double time) {
  const double dx = L / cells;
  Field S(cells);
  for (int i = 0; i < cells; ++i) S(i) = 0.5 + 0.4 * std::cos(kPi * (i + 0.5) / cells);
  const auto slope = [&](const Field& s) {
    Field rate = Field::Zero(cells);
    for (int i = 0; i + 1 < cells; ++i) {
      const double D = 0.5 * kD * (std::exp(beta * s(i)) + std::exp(beta * s(i + 1)));
      const double flow = D * (s(i + 1) - s(i)) / (dx * dx);
      rate(i) += flow;
      rate(i + 1) -= flow;
    }
    return rate;
  };
  const int steps = static_cast<int>(std::ceil(time * kD * std::exp(0.9 * beta) / (0.4 * dx * dx)));
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const Field a = slope(S), b = slope(S + 0.5 * h * a), c = slope(S + 0.5 * h * b), d = slope(S + h * c);
    S += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return S;
}

TEST(Diffusion, ThatFollowsTheSaturationAgreesWithAFineBar) {
  const double L = 0.2, beta = 2.5;
  const double time = 0.1 * L * L / (kPi * kPi * kD);
  const int fine = 512;
  const Field reference = integrate_bar(fine, L, beta, time);
  const Field constant = integrate_bar(128, L, 0.0, time);
  EXPECT_GT(std::abs(constant(10) - reference(4 * 10)), 0.03);  // β matters here
  for (const DiffusionScheme scheme : kSchemes) {
    std::vector<double> sizes, errors;
    for (const int cells : {8, 16, 32}) {
      const mesh::TetMesh mesh = test::make_mirrored_block(cells, 1, 1, Vec3(L, L / cells, L / cells));
      const Points centres = compute_centroids(mesh);
      const Field start = 0.5 + 0.4 * (kPi / L * centres.row(0).transpose().array()).cos();
      // The implicit step shrinks with the square of the cells, so that both errors are of second order.
      const Field S = diffuse(mesh, make_params(scheme, FluxForm::corrected, beta), start, time,
                              scheme == DiffusionScheme::explicit_euler ? 1 : cells * cells);
      double worst = 0.0;
      for (int t = 0; t < S.size(); ++t) {
        const double at = centres(0, t) / L * fine - 0.5;
        const int i = std::clamp(static_cast<int>(at), 0, fine - 2);
        worst = std::max(worst, std::abs(S(t) - std::lerp(reference(i), reference(i + 1), at - i)));
      }
      sizes.push_back(1.0 / cells);
      errors.push_back(worst);
      std::printf("beta %.1f, %2d cells: error %.3e\n", beta, cells, worst);
    }
    EXPECT_GT(fit_order(sizes, errors), 1.7);
    EXPECT_LT(fit_order(sizes, errors), 2.3);
  }
}

TEST(ImplicitDiffusion, KeepsBoundsAndWaterAtAnyStep) {
  const mesh::TetMesh mesh = test::make_shaken_block(4);
  const mesh::Topology topology = mesh::make_topology(mesh);
  for (const FluxForm flux : {FluxForm::two_point, FluxForm::corrected})
    for (const double beta : {0.0, 4.0, -4.0})
      for (const double ratio : {0.1, 1.0, 30.0, 1e3, 1e6}) {
        Field start = Field::Zero(mesh.num_tets());
        for (int t = 0; t < start.size(); t += 7) start(t) = 1.0;
        PoreWater water(mesh, topology, make_params(DiffusionScheme::implicit_euler, flux, beta), start);
        for (int i = 0; i < 5; ++i) {
          water.diffuse(ratio * water.monotone_step());
          ASSERT_GE(water.saturation().minCoeff(), 0.0);
          ASSERT_LE(water.saturation().maxCoeff(), 1.0);
        }
        EXPECT_LT(std::abs(water.ledger_error()), 1e-14);
        if (ratio == 1e6) {
          EXPECT_LT(water.saturation().maxCoeff() - water.saturation().minCoeff(), 1e-4);
        }
      }
}

TEST(ImplicitDiffusion, AgreesWithExplicitDiffusionInSmallSteps) {
  const mesh::TetMesh mesh = shapes::make_shape_mesh({shapes::ShapeKind::cylinder, 0.1}, 1500);
  const Points centres = compute_centroids(mesh);
  const double bottom = centres.row(2).minCoeff();
  const Field start = 0.5 + 0.4 * (kPi / 0.1 * (centres.row(2).transpose().array() - bottom)).cos();
  const double time = 0.02 * 0.01 / kD;
  for (const FluxForm flux : {FluxForm::two_point, FluxForm::corrected}) {
    const Field reference =
        diffuse(mesh, make_params(DiffusionScheme::explicit_euler, flux), start, time, 800);
    double last = 1.0;
    for (const int steps : {5, 10, 20, 40}) {
      const Field S = diffuse(mesh, make_params(DiffusionScheme::implicit_euler, flux), start, time, steps);
      const double error = (S - reference).cwiseAbs().maxCoeff();
      std::printf("%2d steps: %.3e\n", steps, error);
      EXPECT_LT(error, 0.65 * last);  // first order, and nothing left over from the limiter or the iteration
      last = error;
    }
    EXPECT_LT(last, 2e-3);
  }
}

}  // namespace
}  // namespace argil::water
