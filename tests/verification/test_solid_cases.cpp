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

/// Errors at a cell, or step, and at half of it fall at the design order.
void expect_order(double coarse, double fine, double order) {
  EXPECT_GT(std::log2(coarse / fine), order - 0.15);
  EXPECT_LT(std::log2(coarse / fine), order + 0.3);
}

TEST(Cantilever, ReachesTimoshenkosDeflection) {
  // ν = 0: no clamped edge effect but that of the end's warping, some 0.1 %.
  const double exact = compute_timoshenko_deflection(0.0);
  EXPECT_NEAR(solve_cantilever(ElementKind::p2, 0.0, 3), exact, 3e-3 * exact);
  // P1 is stiffer by a share that falls with the square of the cell: the shear that bending gives it.
  const double coarse = exact / solve_cantilever(ElementKind::p1, 0.0, 3) - 1.0;
  const double fine = exact / solve_cantilever(ElementKind::p1, 0.0, 6) - 1.0;
  EXPECT_GT(fine, 0.0);
  expect_order(coarse, fine, 2.0);
}

TEST(Torsion, OfASquareBarIsSaintVenants) {
  // P2's error falls with the fourth power of the cell: what that leaves is less than what it took away.
  const double p2 = solve_torsion(ElementKind::p2, 4);
  const double correction = (p2 - solve_torsion(ElementKind::p2, 2)) / 15.0;
  EXPECT_NEAR(p2 + correction, kSquareTorsion, std::abs(correction));
  const double coarse = solve_torsion(ElementKind::p1, 4) - kSquareTorsion;
  const double fine = solve_torsion(ElementKind::p1, 8) - kSquareTorsion;
  EXPECT_GT(fine, 0.0);  // from above: the twist is prescribed
  expect_order(coarse, fine, 2.0);
}

TEST(TwistedBeam, ComesToTheLiteraturesDeflections) {
  const double width = solve_twisted_beam(ElementKind::p2, TipForce::along_width, 1);
  EXPECT_NEAR(width, kTwistedAlongWidth, 0.01 * kTwistedAlongWidth);
  const double thickness = solve_twisted_beam(ElementKind::p2, TipForce::along_thickness, 1);
  EXPECT_NEAR(thickness, kTwistedAlongThickness, 0.01 * kTwistedAlongThickness);
}

TEST(CooksMembrane, ComesToTheLiteraturesDeflection) {
  // From the stiff side; 1 % for the corner at the clamp, where the stress has no bound.
  EXPECT_LT(solve_cook(ElementKind::p2, 1.0 / 3.0, false, 6),
            solve_cook(ElementKind::p2, 1.0 / 3.0, false, 12));
  EXPECT_NEAR(solve_cook(ElementKind::p2, 1.0 / 3.0, false, 12), kCookPlaneStress, 0.01 * kCookPlaneStress);
}

TEST(ManufacturedSolution, IsApproachedAtTheDesignOrders) {
  const auto check = [](ElementKind element, double nu, int n, double l2, double h1) {
    const FieldErrors coarse = solve_manufactured(element, nu, n);
    const FieldErrors fine = solve_manufactured(element, nu, 2 * n);
    expect_order(coarse.l2, fine.l2, l2);
    expect_order(coarse.h1, fine.h1, h1);
  };
  check(ElementKind::p1, 0.3, 8, 2.0, 1.0);
  check(ElementKind::p1_nodal, 0.45, 8, 2.0, 1.0);
  check(ElementKind::p2, 0.3, 3, 3.0, 2.0);
}

TEST(NearlyIncompressibleBar, BendsWithNodalVolumesAtTheOrderOfP1AndLocksWithout) {
  const double reference = solve_cantilever(ElementKind::p2, 0.4999, 4);
  const auto excess = [&](ElementKind element, int n, StrainModel model = StrainModel::linear) {
    return reference / solve_cantilever(element, 0.4999, n, model) - 1.0;  // of the stiffness
  };
  const double coarse = excess(ElementKind::p1_nodal, 3);
  const double fine = excess(ElementKind::p1_nodal, 6);
  expect_order(coarse, fine, 2.0);
  EXPECT_GT(excess(ElementKind::p1, 6), excess(ElementKind::p1_nodal, 3));  // not even half the cell helps it
  for (const StrainModel model : {StrainModel::corotational, StrainModel::neo_hookean})
    EXPECT_NEAR(excess(ElementKind::p1_nodal, 3, model), coarse, 0.01 * coarse);  // 0.2 % of strain
}

TEST(NodalVolumes, LeaveNoCheckerboardFree) {
  // The averaged energy is what P1 has at ν = 0.3 and something positive, which is less than P1 would add: a
  // mean's square is below the mean of squares. So each frequency lies between those of two P1 bodies of the
  // same shear modulus [Courant's minimum-maximum principle], and no pattern of volumes is free.
  for (const double nu : {0.3, 0.4, 0.49, 0.4999}) {
    const std::vector<double> low = find_frequencies(ElementKind::p1, 0.3, 4, 40);
    const std::vector<double> found = find_frequencies(ElementKind::p1_nodal, nu, 4, 40);
    const std::vector<double> high = find_frequencies(ElementKind::p1, nu, 4, 40);
    const double same_shear = std::sqrt(1.3 / (1.0 + nu));  // E is the same in all of them
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_GE(found[i], (1.0 - 1e-9) * same_shear * low[i]) << nu << ' ' << i;
      EXPECT_LE(found[i], (1.0 + 1e-9) * high[i]) << nu << ' ' << i;
    }
  }
}

TEST(SpinningBody, LosesInBackwardEulerWhatARigidOneDoes) {
  // 30 MPa: the spin strains the bar by some ρω²L²/E = 10⁻⁴.
  for (const int steps : {100, 200, 400}) {
    const SpinDrift expected = compute_rigid_spin(steps);
    const SpinDrift found = solve_spin(Integrator::backward_euler, Iteration::newton, steps, 3e7);
    EXPECT_NEAR(found.momentum, expected.momentum, 3e-4 * expected.momentum) << steps;
    EXPECT_NEAR(found.energy, expected.energy, 3e-4 * expected.energy) << steps;
    // One linearised step keeps the frame, about which its forces have no moment: little is lost.
    const SpinDrift one = solve_spin(Integrator::backward_euler, Iteration::one, steps, 3e7);
    EXPECT_LT(one.momentum, 0.1 * expected.momentum) << steps;
  }
}

TEST(SpinningBody, KeepsItsAngularMomentumAtTheOrderOfTheStep) {
  // Four levels: the body breathes, and where in a breath the turn ends differs from step to step.
  for (const Integrator integrator : {Integrator::bdf2, Integrator::newmark}) {
    const double coarse = solve_spin(integrator, Iteration::newton, 100).momentum;
    const double fine = solve_spin(integrator, Iteration::newton, 800).momentum;
    const double order = std::log2(coarse / fine) / 3.0;
    EXPECT_GT(order, 2.0 - 0.15) << static_cast<int>(integrator);
    EXPECT_LT(order, 2.0 + 0.3) << static_cast<int>(integrator);
  }
  // Forces at the start of a step have no moment about its positions: kept to rounding.
  EXPECT_LT(solve_spin(Integrator::symplectic_euler, Iteration::one, 400).momentum, 1e-13);
}

}  // namespace
}  // namespace argil::verification
