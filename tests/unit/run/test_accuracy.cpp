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

/// A force that is off by 1 % for each tick of the step.
TEST(StepPasses, KnowWhatStepsOfAnyLengthDo) {
  const StepPasses passes{2, 5, make_pass(1.0, 0.02), make_pass(1.0, 0.05)};
  EXPECT_NEAR(passes.find_error_of_a_tick(0.0), 0.01, 2e-4);  // over a force that is 2 % too large
  for (const int ticks : {1, 2, 4, 5}) {
    const double error = 0.01 * ticks;
    EXPECT_LT(compare_forces(passes.at(ticks).haptic, make_press(error), 0.0), 1e-12) << ticks;
  }
}

TEST(ChooseStep, TakesTheLongestWhoseErrorLeavesRoomForThatOfCells) {
  const std::vector<int> lengths = {1, 2, 5, 10};
  EXPECT_EQ(choose_step(lengths, 5, 0.005, 0.05), 5);
  EXPECT_EQ(choose_step(lengths, 5, 0.01, 0.05), 2);  // 5 would be all of it
  EXPECT_EQ(choose_step(lengths, 5, 0.0, 0.05), 5);   // and none that was not tried
  EXPECT_EQ(choose_step(lengths, 5, 0.03, 0.02), 1);
}

TEST(FindStepLengths, AreDivisorsOfThePeriodsThatGoWithTheStep) {
  scenario::Scenario s;
  s.params.rates.water_period_ticks = 30;
  s.params.rates.frame_period_ticks = 100;
  EXPECT_EQ(find_step_lengths(s), (std::vector<int>{1, 2, 5, 10}));
  s.params.rates.water_period_ticks = 7;
  EXPECT_EQ(find_step_lengths(s), std::vector<int>{1});
  s.params.solid.integrator = solid::Integrator::symplectic_euler;
  EXPECT_TRUE(find_step_lengths(s).empty());
}

}  // namespace
}  // namespace argil::run
