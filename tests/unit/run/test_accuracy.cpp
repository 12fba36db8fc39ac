// How cells are chosen for a wanted accuracy of the force: by errors that are known.
#include "run/accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace argil::run {
namespace {

/// A press and its release of 1 N; `error`: of the force, over it.
std::vector<sim::HapticRecord> make_press(double error) {
  std::vector<sim::HapticRecord> ticks(40);
  for (std::size_t i = 10; i < 30; ++i) {
    ticks[i].num_contacts = 1;
    ticks[i].force = Vec3(0.0, 0.0, (1.0 + error) * std::sin(0.15 * static_cast<double>(i - 10)));
  }
  return ticks;
}

AccuracyPass make_pass(double cells, double error) {
  return {cells, 0, make_press(error), error};
}

TEST(CompareForces, IsTheShareThatForcesAreOffWhileTheyTouch) {
  EXPECT_NEAR(compare_forces(make_press(0.03), make_press(0.0), 0.0), 0.03, 1e-12);
  EXPECT_EQ(compare_forces(make_press(0.0), make_press(0.0), 0.0), 0.0);
  std::vector<sim::HapticRecord> longer = make_press(0.03);
  longer.resize(100);  // ticks that one of them lacks, and that touch nothing
  EXPECT_NEAR(compare_forces(longer, make_press(0.0), 0.0), 0.03, 1e-12);
}

TEST(CompareForces, DoesNotCountWhatLiesBelowTheFloor) {
  std::vector<sim::HapticRecord> weak = make_press(0.0), weaker = make_press(0.0);
  for (auto& tick : weak) tick.force *= 1e-3;
  for (auto& tick : weaker) tick.force *= 0.5e-3;
  // 0.35 mN rms of difference against a floor of 0.5 N.
  EXPECT_NEAR(compare_forces(weaker, weak, 0.5), 0.35e-3 / 0.5, 0.1e-3);
}

TEST(CompareForces, IsNothingOfRunsThatTouchNothing) {
  const std::vector<sim::HapticRecord> idle(20);
  EXPECT_EQ(compare_forces(idle, idle, 0.5), 0.0);
}

/// Errors that fall as the size of cells to the power 3/2, to one side or from one side to the other.
TEST(EstimateError, IsThatOfTheFinerPass) {
  for (const double refinement : {1.6, 2.0}) {
    const double fine = 0.01, coarse = fine * std::pow(refinement, 1.5);
    const AccuracyPass pass = make_pass(refinement, fine);
    const double of_one_side = estimate_error(make_pass(1.0, coarse), pass, 0.0);
    EXPECT_GT(of_one_side, 0.5 * fine) << refinement;
    EXPECT_LT(of_one_side, fine) << refinement;
    const double of_both_sides = estimate_error(make_pass(1.0, -coarse), pass, 0.0);
    EXPECT_GT(of_both_sides, fine) << refinement;
    EXPECT_LT(of_both_sides, 1.6 * fine) << refinement;
  }
}

TEST(ChooseCells, TakesMoreForLessErrorAndNoFewerThanSayAnything) {
  const double for_five = choose_cells({}, 0.05), for_two = choose_cells({}, 0.02),
               for_one = choose_cells({}, 0.01);
  EXPECT_LT(for_five, for_two);
  EXPECT_LT(for_two, for_one);
  EXPECT_GE(choose_cells({}, 0.5), 0.7);
  EXPECT_NEAR(choose_cells({make_pass(for_one, 0.0)}, 0.01) / for_one, 1.6, 1e-9);
}

TEST(ChooseCells, ComesBelowTheWantedErrorFromOneThatIsKnown) {
  // 3 % on two cells along the radius are 1.06 % on four.
  const std::vector<AccuracyPass> passes = {make_pass(1.0, 0.08), make_pass(2.0, 0.03)};
  const double cells = choose_cells(passes, 0.015);
  EXPECT_LT(0.03 * std::pow(2.0 / cells, 1.5), 0.015);
  EXPECT_LE(cells, 4.0);  // and no farther at once
  EXPECT_GT(choose_cells(passes, 0.031), 2.0);
}

}  // namespace
}  // namespace argil::run
