// A virtual wall in the hand of a simulated operator, in closed loop with the simulation's own ticks.
#include <gtest/gtest.h>

#include <utility>

#include "stability.h"

namespace argil::verification {
namespace {

using contact::ContactLaw;
using contact::PenaltyKind;
using device::Passivity;
using sim::BetweenFrames;

TEST(StableStiffness, OfAHeldForceTendsToTwiceTheDampingOverThePeriod) {
  // b > K T/2, the passive wall [Colgate1997], is what the polynomial gives for a heavy hand, K T² ≪ m; the
  // mean over the motion is late by T instead of T/2 and halves it.
  Operator heavy;
  heavy.mass = 10.0;
  EXPECT_NEAR(compute_stable_stiffness(heavy, 1e-3, PenaltyKind::discrete), 1000.0, 1.0);
  EXPECT_NEAR(compute_stable_stiffness(heavy, 1e-3, PenaltyKind::continuous), 500.0, 0.5);
}

TEST(StableStiffness, OfAWallIsThatOfTheCharacteristicPolynomial) {
  const Operator hand;
  for (const auto& [law, penalty] : {std::pair(ContactLaw::pressure, PenaltyKind::discrete),
                                    std::pair(ContactLaw::pairs, PenaltyKind::discrete),
                                    std::pair(ContactLaw::pairs, PenaltyKind::continuous)})
    for (const int period : {1, 14}) {
      Wall wall;
      wall.law = law;
      wall.penalty = penalty;
      wall.physics_period_ticks = period;
      const double K = compute_stable_stiffness(hand, 1e-3 * period, penalty);
      for (const double factor : {0.95, 1.05}) {
        const Closed closed = run_closed_loop(wall, hand, factor * K, Start::nudge);
        EXPECT_EQ(closed.dies_away(Start::nudge), factor < 1.0)
            << K << ' ' << period << ' ' << static_cast<int>(law);
      }
    }
}

TEST(StableStiffness, OfAYieldingBodyIsNotBoundByThePenaltyWhereTheSurfaceFollows) {
  // At 71 Hz the held series spring must stay below 2b/T; a force that is carried on between frames is that of
  // the series at 1 kHz, which its softer part keeps below 2b/δ.
  const Operator hand;
  Wall wall;
  wall.gives_way = true;
  wall.physics_period_ticks = 14;
  const auto is_stable = [&](BetweenFrames between, double k) {
    wall.between = between;
    return run_closed_loop(wall, hand, k, Start::nudge).dies_away(Start::nudge);
  };
  EXPECT_FALSE(is_stable(BetweenFrames::hold, 200.0));
  EXPECT_TRUE(is_stable(BetweenFrames::re_evaluate, 200.0));
  EXPECT_TRUE(is_stable(BetweenFrames::re_evaluate, 2000.0));
  EXPECT_TRUE(is_stable(BetweenFrames::re_evaluate, 1e5));
}

TEST(PassivityController, KeepsAWallFromThrowingTheHandOff) {
  // Eight times the stable stiffness: the bounces grow without it and die with it, and its observer stays
  // above zero but for what one tick can bring.
  Operator hand;
  hand.damping = 0.1;
  Wall wall;
  const double K = 8.0 * compute_stable_stiffness(hand, 1e-3, PenaltyKind::discrete);
  const Closed open = run_closed_loop(wall, hand, K, Start::drop);
  EXPECT_GT(open.last_speed, open.begin_speed);
  EXPECT_LT(open.lowest_energy, -10.0 * open.largest_step);
  wall.passivity = Passivity::time_domain;
  const Closed closed = run_closed_loop(wall, hand, K, Start::drop);
  EXPECT_TRUE(closed.dies_away(Start::drop));
  EXPECT_GT(closed.lowest_energy, -closed.largest_step);
}

}  // namespace
}  // namespace argil::verification
