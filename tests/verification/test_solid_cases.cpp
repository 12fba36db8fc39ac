// The solid against closed forms and values of the literature, at meshes that take seconds; finer ones are in
// results/verification.
#include <cmath>

#include <gtest/gtest.h>

#include "solid_cases.h"

namespace argil::verification {
namespace {

using solid::ElementKind;
using solid::Integrator;
using solid::Iteration;
using solid::StrainModel;

TEST(Cantilever, ReachesTimoshenkosDeflection) {
  // ν = 0: no clamped edge effect but that of the end's warping, some 0.1 %.
  const double exact = compute_timoshenko_deflection(0.0);
  EXPECT_NEAR(solve_cantilever(ElementKind::p2, 0.0, 3), exact, 3e-3 * exact);
  // P1 from below, at second order in the cell.
  const double coarse = 1.0 - solve_cantilever(ElementKind::p1, 0.0, 3) / exact;
  const double fine = 1.0 - solve_cantilever(ElementKind::p1, 0.0, 6) / exact;
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(std::log2(coarse / fine), 1.75, 0.3);
}

TEST(Torsion, OfASquareBarIsSaintVenants) {
  EXPECT_NEAR(solve_torsion(ElementKind::p2, 4), kSquareTorsion, 5e-3 * kSquareTorsion);  // of the mesh
  const double coarse = solve_torsion(ElementKind::p1, 4) - kSquareTorsion;
  const double fine = solve_torsion(ElementKind::p1, 8) - kSquareTorsion;
  EXPECT_GT(fine, 0.0);  // from above: the twist is prescribed
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3);
}

TEST(CooksMembrane, ComesToTheLiteraturesDeflection) {
  EXPECT_NEAR(solve_cook(ElementKind::p2, 1.0 / 3.0, false, 12), kCookPlaneStress, 0.01 * kCookPlaneStress);
}

TEST(ManufacturedSolution, IsApproachedAtTheDesignOrders) {
  const auto check = [](ElementKind element, double nu, int n, double l2, double h1) {
    const FieldErrors coarse = solve_manufactured(element, nu, n);
    const FieldErrors fine = solve_manufactured(element, nu, 2 * n);
    EXPECT_NEAR(std::log2(coarse.l2 / fine.l2), l2, 0.3);
    EXPECT_NEAR(std::log2(coarse.h1 / fine.h1), h1, 0.3);
  };
  check(ElementKind::p1, 0.3, 6, 2.0, 1.0);
  check(ElementKind::p1_nodal, 0.45, 6, 2.0, 1.0);
  check(ElementKind::p2, 0.3, 3, 3.0, 2.0);
}

TEST(NearlyIncompressibleBar, BendsWithNodalVolumesAndLocksWithout) {
  const double reference = solve_cantilever(ElementKind::p2, 0.4999, 4);
  EXPECT_LT(solve_cantilever(ElementKind::p1, 0.4999, 4), 0.2 * reference);
  const double nodal = solve_cantilever(ElementKind::p1_nodal, 0.4999, 4);
  const double easy = solve_cantilever(ElementKind::p1, 0.3, 4) / solve_cantilever(ElementKind::p2, 0.3, 4);
  EXPECT_GT(nodal / reference, 0.9 * easy);  // within a tenth of P1 where nothing locks
  EXPECT_LT(nodal / reference, 1.02);
  for (const StrainModel model : {StrainModel::corotational, StrainModel::neo_hookean})
    EXPECT_NEAR(solve_cantilever(ElementKind::p1_nodal, 0.4999, 4, model), nodal, 0.01 * nodal);
}

TEST(NodalVolumes, LeaveNoCheckerboardFree) {
  // A pattern of volume changes without stiffness would be a frequency far below the body's own.
  for (const double nu : {0.3, 0.49, 0.4999}) {
    const std::vector<double> expected = find_frequencies(ElementKind::p2, nu, 3, 12);
    const std::vector<double> found = find_frequencies(ElementKind::p1_nodal, nu, 4, 12);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_GT(found[i], 0.95 * expected[i]) << nu << ' ' << i;
      EXPECT_LT(found[i], 1.35 * expected[i]) << nu << ' ' << i;
    }
  }
}

TEST(SpinningBody, KeepsItsAngularMomentumAtTheOrderOfTheStep) {
  const auto check = [](Integrator integrator, Iteration iteration, double order) {
    const double coarse = solve_spin(integrator, iteration, 200).momentum;
    const double fine = solve_spin(integrator, iteration, 400).momentum;
    EXPECT_GT(std::log2(coarse / fine), order - 0.3) << static_cast<int>(integrator);
    EXPECT_LT(fine, 0.2) << static_cast<int>(integrator);
  };
  check(Integrator::backward_euler, Iteration::newton, 1.0);
  check(Integrator::bdf2, Iteration::newton, 2.0);
  check(Integrator::newmark, Iteration::newton, 2.0);
  // One linearised step errs the other way than backward Euler loses: little is left, at no clean order.
  EXPECT_LT(solve_spin(Integrator::backward_euler, Iteration::one, 200).momentum, 0.01);
}

}  // namespace
}  // namespace argil::verification
