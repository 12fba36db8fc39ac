// What `fidelity: auto` leaves out, beside the full model of the same motion: the force at the hand stays
// within its bound, nothing is left out where the estimate says that it matters, switches neither chatter nor
// kick.
#include "sim/fidelity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.012;
constexpr double kHeight = 0.02;  // of the block [m]

// The indicators alone.

Fidelity make_fidelity(double damped_steps = 0.0) {
  FidelityParams params;
  params.mode = FidelityMode::automatic;
  params.force_tolerance = 0.01;
  params.force_floor = 0.02;
  return Fidelity(params, damped_steps);
}

/// ‖g‖ of Betti's theorem, with the factor 2 of the safety: √n where all nodes go with the hand, 1 where one
/// does.
TEST(Fidelity, ForceReachesAsFarAsNodesGoWithTheHand) {
  const Points rest = Points::Zero(3, 100);
  Points all = rest, one = rest;
  all.row(2).setConstant(1e-3);
  one(2, 7) = 1e-3;
  Fidelity fidelity = make_fidelity();
  fidelity.begin_step(Vec3::Zero());
  fidelity.find_reach(one, rest, OrderedItems(1));
  const double of_one = fidelity.solve_slack();
  fidelity.find_reach(all, rest, OrderedItems(1));
  EXPECT_DOUBLE_EQ(fidelity.solve_slack(), of_one / 10.0);
  fidelity.find_reach(rest, rest, OrderedItems(1));  // nothing has moved: any of them may
  EXPECT_DOUBLE_EQ(fidelity.solve_slack(), of_one / 10.0);
}

TEST(Fidelity, ErrorMayBeAShareOfTheForceOrTheFloor) {
  Fidelity fidelity = make_fidelity();
  fidelity.begin_step(Vec3(0, 0, 1.0));
  EXPECT_DOUBLE_EQ(fidelity.record().bound, 0.02);
  fidelity.begin_step(Vec3(0, 3.0, 4.0));
  EXPECT_DOUBLE_EQ(fidelity.record().bound, 0.05);
}

TEST(Fidelity, SolvesMoreExactlyWhileTheForceChanges) {
  Fidelity fidelity = make_fidelity();
  fidelity.begin_step(Vec3(0, 0, 1.0));
  const double changing = fidelity.solve_slack();
  fidelity.begin_step(Vec3(0, 0, 1.0));
  EXPECT_DOUBLE_EQ(fidelity.solve_slack(), changing * (0.02 + 1.0) / 0.02);
}

/// A damped body answers a contact that comes or goes with more than its stiffness at rest, and what its
/// solves left lasts for as many steps.
TEST(Fidelity, SolvesADampedBodyMoreExactly) {
  constexpr double kDampedSteps = 36.0, kShare = 6.0;  // its root
  Fidelity free = make_fidelity(), damped = make_fidelity(kDampedSteps);
  const double imbalance = 1e-5;
  for (Fidelity* fidelity : {&free, &damped}) {
    fidelity->begin_step(Vec3(0, 0, 1.0));
    fidelity->find_reach(Points::Zero(3, 1), Points::Zero(3, 1), OrderedItems(1));
    fidelity->set_made(true, imbalance, 0.0);
  }
  EXPECT_DOUBLE_EQ(damped.solve_slack(), free.solve_slack() / kShare);
  EXPECT_DOUBLE_EQ(damped.record().estimate, kShare * free.record().estimate);
  damped.set_made(true, damped.solve_limit(), 0.0);
  EXPECT_DOUBLE_EQ(damped.record().estimate, damped.record().bound);
}

/// One mode that relaxes: its imbalance falls by e^{−h/τ} a step. It may stop when what is left of it is
/// below the bound's share, after the steps that the estimate must have held for, and never while clay flows.
TEST(Fidelity, ARelaxingModeFallsAsleepWhenLittleIsLeft) {
  constexpr double kDecay = 0.9;
  Fidelity fidelity = make_fidelity();
  const Points rest = Points::Zero(3, 1);
  double imbalance = 1.0;
  int steps = 0;
  for (bool sleeps = false; !sleeps; imbalance *= kDecay, ++steps) {
    fidelity.begin_step(Vec3::Zero());
    fidelity.find_reach(rest, rest, OrderedItems(1));
    sleeps = fidelity.falls_asleep(imbalance, 0.0, false);
  }
  const int first_calm = static_cast<int>(std::ceil(std::log(0.4 * 0.02 / 2.0) / std::log(kDecay)));
  EXPECT_EQ(steps, first_calm + 8);
  EXPECT_EQ(fidelity.record().rung, Rung::asleep);
  EXPECT_LT(fidelity.record().estimate, 0.4 * 0.02);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(fidelity.falls_asleep(0.0, 0.0, true));
}

/// What falls asleep at an imbalance sleeps on at twice that.
TEST(Fidelity, WakesFarFromWhereItFellAsleep) {
  Fidelity fidelity = make_fidelity();
  fidelity.begin_step(Vec3::Zero());
  fidelity.find_reach(Points::Zero(3, 1), Points::Zero(3, 1), OrderedItems(1));
  const double falls = 0.4 * 0.02 / 2.0;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(fidelity.falls_asleep(1.01 * falls, 0.0, false));
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(fidelity.falls_asleep(0.99 * falls, 0.0, false));
  EXPECT_TRUE(fidelity.falls_asleep(0.99 * falls, 0.0, false));
  EXPECT_TRUE(fidelity.sleeps_on(1.99 * falls, 0.0));
  EXPECT_FALSE(fidelity.sleeps_on(2.01 * falls, 0.0));
  const double held_back = 0.2 * 0.02;  // felt as it is, out of the same bound
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(fidelity.falls_asleep(0.76 * falls, held_back, false));
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(fidelity.falls_asleep(0.74 * falls, held_back, false));
  EXPECT_TRUE(fidelity.falls_asleep(0.74 * falls, held_back, false));
  EXPECT_TRUE(fidelity.sleeps_on(1.49 * falls, held_back));
  EXPECT_FALSE(fidelity.sleeps_on(1.51 * falls, held_back));
}

// Beside the full model.

Params make_params(FidelityMode mode, int threads = 1) {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.yield = 0.02;
  p.kernel.form = material::KernelForm::rate;
  p.kernel.radius = 0.02;
  p.contact = {300.0, 300.0};
  p.solid.rayleigh_stiffness = 1e-3;
  p.fidelity.mode = mode;
  p.threads = threads;
  return p;
}

Body make_body() {
  return test::make_block_body(6, 6, 4, Vec3(0.03, 0.03, kHeight));
}

/// The tool's lowest point over the block [m].
device::DeviceSample hand_over(double height) {
  device::DeviceSample sample;
  sample.position = {0.0153, 0.0148, kHeight + kToolRadius + height};
  sample.mode = device::ToolMode::push;
  return sample;
}

/// Down 1.5 mm in 80 ticks, at rest for 300, up in 80, away.
device::DeviceSample press_at(Tick tick) {
  const auto t = static_cast<double>(tick);
  const double way = std::clamp(std::min(t, 460.0 - t) / 80.0, 0.0, 1.0);
  return hand_over(3e-4 - 1.8e-3 * way);
}

constexpr Tick kPressTicks = 600;

Simulation make_simulation(const Params& params) {
  return {make_body(), contact::make_sphere_tool(kToolRadius, 2), params, hand_over(3e-4)};
}

struct Comparison {
  double error = 0.0;     ///< largest, over its bound
  double estimate = 0.0;  ///< smallest over the true error where that counts
  double kick = 0.0;      ///< largest change of the force's error at a switch, over the bound
  int switches = 0;
  int asleep = 0;     ///< steps
  int coasting = 0;   ///< steps
  double rows = 0.0;  ///< assembled in steps that were solved, over those of the full model in the same
  double peak = 0.0;  ///< [N]
};

template <class Hand>
Comparison compare(Hand hand, Tick num_ticks) {
  Simulation full = make_simulation(make_params(FidelityMode::full));
  Simulation lean = make_simulation(make_params(FidelityMode::automatic));
  Comparison result;
  result.estimate = 1e300;
  Rung last = Rung::asleep;
  Vec3 last_error = Vec3::Zero();
  double rows = 0.0, all_rows = 0.0;
  for (Tick k = 1; k <= num_ticks; ++k) {
    EXPECT_TRUE(full.tick(hand(k)).is_ok() && lean.tick(hand(k)).is_ok()) << k;
    const FidelityRecord record = lean.physics_record().fidelity;
    const Vec3 error = lean.hand_state().hand_force - full.hand_state().hand_force;
    result.error = std::max(result.error, error.norm() / record.bound);
    if (error.norm() > 0.02 * record.bound)
      result.estimate = std::min(result.estimate, record.estimate / error.norm());
    if ((record.rung == Rung::asleep) != (last == Rung::asleep)) {
      ++result.switches;
      result.kick = std::max(result.kick, (error - last_error).norm() / record.bound);
    }
    if (record.rung == Rung::solved) {
      rows += lean.solid().history.counters.assembled_rows;
      all_rows += full.solid().history.counters.assembled_rows;
    }
    result.asleep += record.rung == Rung::asleep;
    result.coasting += record.rung == Rung::coasting;
    result.peak = std::max(result.peak, full.hand_state().hand_force.norm());
    last = record.rung;
    last_error = error;
  }
  result.rows = rows / all_rows;
  return result;
}

/// The body sleeps under the resting tool and after it has left, and the hand does not feel it.
TEST(FidelityAuto, KeepsTheForceOfAPressWithARest) {
  const Comparison press = compare(press_at, kPressTicks);
  EXPECT_GT(press.peak, 0.5);
  EXPECT_LT(press.error, 1.0);
  EXPECT_GT(press.estimate, 1.0);
  EXPECT_LT(press.kick, 0.5);
  EXPECT_GT(press.asleep, 120);
  EXPECT_GT(press.coasting, 40);
  EXPECT_LT(press.rows, 0.5);  // frames lag
  EXPECT_LE(press.switches, 4);
}

/// A tool that rests but for a slow to and fro, a period a second, at whose ends the force has changed by
/// about as much as a sleeping body may hold back.
TEST(FidelityAuto, DoesNotChatterAtTheEdgeOfSleep) {
  for (const double amplitude : {1e-6, 3e-6, 1e-5}) {
    const auto hand = [amplitude](Tick tick) {
      const auto t = static_cast<double>(tick);
      const double way = std::min(t / 80.0, 1.0);
      const double sway = t < 400.0 ? 0.0 : amplitude * std::sin(2.0 * M_PI * 1e-3 * (t - 400.0));
      return hand_over(3e-4 - 1.3e-3 * way + sway);
    };
    const Comparison rest = compare(hand, 2400);
    EXPECT_LE(rest.switches, 2 + 4 * 2) << amplitude;  // at most twice a half period
    EXPECT_LT(rest.error, 1.0) << amplitude;
    EXPECT_LT(rest.kick, 1.0) << amplitude;
  }
}

/// A tool that rests low at the block's side presses nodes that are held, too: what these carry does not wake
/// the body, whichever part of it a step solves for.
TEST(FidelityAuto, SleepsOnForcesOfNodesThatAreHeld) {
  const auto hand = [](Tick tick) {
    device::DeviceSample sample;
    const double way = 1.3e-3 * std::min(static_cast<double>(tick) / 80.0, 1.0) - 3e-4;
    sample.position = {way - kToolRadius, 0.0148, 0.002};
    sample.mode = device::ToolMode::push;
    return sample;
  };
  for (const Extent extent : {Extent::whole, Extent::local}) {
    Params params = make_params(FidelityMode::automatic);
    params.plasticity.enabled = false;
    params.extent = extent;
    Simulation simulation(make_body(), contact::make_sphere_tool(kToolRadius, 2), params, hand(0));
    int asleep = 0, switches = 0;
    Rung last = Rung::asleep;
    for (Tick k = 1; k <= 600; ++k) {
      ASSERT_TRUE(simulation.tick(hand(k)).is_ok()) << k;
      const Rung rung = simulation.physics_record().fidelity.rung;
      switches += (rung == Rung::asleep) != (last == Rung::asleep);
      asleep += rung == Rung::asleep;
      last = rung;
    }
    EXPECT_GT(simulation.hand_state().hand_force.norm(), 0.1);
    EXPECT_GT(asleep, 200) << static_cast<int>(extent);
    EXPECT_LE(switches, 4) << static_cast<int>(extent);
  }
}

/// A post of 100 mm that resists fast strain, bent by a soft tool at its side to and fro.
struct Sway {
  static constexpr Tick kTicks = 320;
  static constexpr double kWidth = 0.024;

  static device::DeviceSample hand_at(Tick tick) {
    const auto t = static_cast<double>(tick);
    const double way = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * t / 160.0);
    device::DeviceSample sample;
    sample.position = {-kToolRadius - 1e-3 + 0.05 * way, 0.5003 * kWidth, 0.0903 - 0.02 * way};
    sample.mode = device::ToolMode::push;
    return sample;
  }
  static Simulation make(FidelityMode mode, double tolerance) {
    Params p;
    p.elastic = {3e5, 0.3};
    p.plasticity.enabled = false;
    p.kernel.form = material::KernelForm::off;
    p.contact = {60.0, 60.0};
    p.solid.rayleigh_stiffness = 0.1;
    p.solid.solver.tolerance = tolerance;
    p.fidelity.mode = mode;
    return {test::make_block_body(3, 3, 12, Vec3(kWidth, kWidth, 0.1)),
            contact::make_sphere_tool(kToolRadius, 2), p, hand_at(0)};
  }
};

/// Seen from a frame that lags, the turning of the post is a strain, which its damping resists.
TEST(FidelityAuto, DampingDoesNotResistATurnByFramesThatLag) {
  Simulation full = Sway::make(FidelityMode::full, 1e-4);
  Simulation lean = Sway::make(FidelityMode::automatic, 1e-4);
  double peak = 0.0, error = 0.0;
  for (Tick k = 1; k <= Sway::kTicks; ++k) {
    ASSERT_TRUE(full.tick(Sway::hand_at(k)).is_ok() && lean.tick(Sway::hand_at(k)).is_ok()) << k;
    const FidelityRecord record = lean.physics_record().fidelity;
    const Vec3 off = lean.hand_state().hand_force - full.hand_state().hand_force;
    peak = std::max(peak, full.hand_state().hand_force.norm());
    error = std::max(error, off.norm() / record.bound);
  }
  EXPECT_GT(peak, 0.5);
  EXPECT_LT(error, 0.5);
}

/// With a solver so loose that it would leave more than the bound.
TEST(FidelityAuto, NoStepIsKeptWhoseOwnEstimateIsAboveItsBound) {
  Simulation lean = Sway::make(FidelityMode::automatic, 0.1);
  for (Tick k = 1; k <= Sway::kTicks; ++k) {
    ASSERT_TRUE(lean.tick(Sway::hand_at(k)).is_ok()) << k;
    const FidelityRecord record = lean.physics_record().fidelity;
    EXPECT_LE(record.estimate, record.bound * (1.0 + 1e-12)) << k;
  }
}

/// A factor's solve has no iterations to be told by.
TEST(FidelityAuto, StepsThatAFactorSolvesDoNotCoast) {
  for (const linear::SolverKind kind : {linear::SolverKind::cholesky, linear::SolverKind::supernodal}) {
    Params params = make_params(FidelityMode::automatic);
    params.solid.solver.kind = kind;
    Simulation simulation = make_simulation(params);
    for (Tick k = 1; k <= 60; ++k) ASSERT_TRUE(simulation.tick(press_at(k)).is_ok());
    EXPECT_GT(simulation.hand_state().hand_force.norm(), 0.1);
    EXPECT_EQ(simulation.physics_record().fidelity.rung, Rung::solved);
  }
}

/// A body without supports falls by backward Euler's ½ g h² k (k + 1), but for the force that may be left
/// without balance: it does not sleep.
TEST(FidelityAuto, AFreeBodyFallsAndIsNotPutToSleep) {
  Params params = make_params(FidelityMode::automatic);
  params.solid.gravity = Vec3(0, 0, -9.81);
  Body body = make_body();
  body.supports.clear();
  Simulation simulation(std::move(body), contact::make_sphere_tool(kToolRadius, 2), params, hand_over(0.05));
  const Points start = simulation.body_state().solid.x;
  constexpr int kSteps = 50;
  for (Tick k = 1; k <= kSteps; ++k) {
    ASSERT_TRUE(simulation.tick(hand_over(0.05)).is_ok());
    EXPECT_NE(simulation.physics_record().fidelity.rung, Rung::asleep) << k;
  }
  const double mass = simulation.solid().materials.mass().sum();
  const double ways = 0.5 * 1e-6 * kSteps * (kSteps + 1);  // h² k (k + 1)/2
  const double fall = (start - simulation.body_state().solid.x).row(2).mean();
  EXPECT_NEAR(fall, 9.81 * ways, 0.02 / mass * ways);
}

/// Long after a touch one of its sides is pushed in by 1 mm. What moves by itself is not put to sleep.
TEST(FidelityAuto, ABodyWithAMovingSupportIsNotPutToSleep) {
  const auto make = [](FidelityMode mode) {
    Body body = make_body();
    solid::Support side;
    side.region.kind = solid::Region::Kind::half_space;
    side.region.normal = -Vec3::UnitX();
    side.region.offset = -0.0299;
    side.displacement = Vec3(-1e-3, 0, 0);
    side.ramp_start = 0.6;
    side.ramp_end = 0.65;
    body.supports.push_back(side);
    return Simulation(std::move(body), contact::make_sphere_tool(kToolRadius, 2), make_params(mode),
                      hand_over(3e-4));
  };
  Simulation full = make(FidelityMode::full);
  Simulation lean = make(FidelityMode::automatic);
  for (Tick k = 1; k <= 700; ++k) {
    ASSERT_TRUE(full.tick(press_at(k)).is_ok() && lean.tick(press_at(k)).is_ok()) << k;
    EXPECT_NE(lean.physics_record().fidelity.rung, Rung::asleep) << k;
  }
  const Points difference = lean.body_state().solid.x - full.body_state().solid.x;
  EXPECT_LT(difference.colwise().norm().maxCoeff(), 0.01 * 1e-3);
}

TEST(FidelityAuto, GivesTheSameBitsAtAnyThreadCountAndOnReturn) {
  Simulation one = make_simulation(make_params(FidelityMode::automatic, 1));
  Simulation two = make_simulation(make_params(FidelityMode::automatic, 2));
  Snapshot asleep, pressing;
  for (Tick k = 1; k <= kPressTicks; ++k) {
    ASSERT_TRUE(one.tick(press_at(k)).is_ok() && two.tick(press_at(k)).is_ok());
    ASSERT_EQ(one.state_hash(), two.state_hash()) << k;
    if (k == 50) pressing = one.take_snapshot();
    if (k == 360) asleep = one.take_snapshot();
  }
  for (const auto& [tick, snapshot] : {std::pair(Tick{50}, pressing), std::pair(Tick{360}, asleep)}) {
    Simulation again = make_simulation(make_params(FidelityMode::automatic, 1));
    again.restore(snapshot, "snapshot");
    for (Tick k = tick + 1; k <= kPressTicks; ++k) ASSERT_TRUE(again.tick(press_at(k)).is_ok());
    EXPECT_EQ(again.state_hash(), one.state_hash()) << tick;
    EXPECT_EQ(again.physics_record().fidelity.estimate, one.physics_record().fidelity.estimate);
  }
}

/// A long bar that is pressed here and, before that has come to rest, faster there. Frames of tets that sleep
/// lag by what was allowed when they last moved, not by what is now.
TEST(FidelityAuto, ABodyOfWhichPartSleepsGivesTheSameBitsOnReturn) {
  constexpr Tick kTicks = 240, kEvery = 8;
  const auto hand = [](Tick tick) {
    const auto t = static_cast<double>(tick);
    const bool is_there = t > 120.0;
    const double way =
        is_there ? std::min((t - 130.0) / 40.0, 1.0) : std::min({t / 40.0, (120.0 - t) / 40.0, 1.0});
    device::DeviceSample sample = hand_over(3e-4 - 2.3e-3 * way);
    sample.position.x() += is_there ? 0.12 : 0.02;
    return sample;
  };
  Params params = make_params(FidelityMode::automatic);
  params.extent = Extent::local;
  params.solid.solver.tolerance = 1e-4;
  const auto make = [&] {
    return Simulation(test::make_block_body(80, 6, 4, Vec3(0.4, 0.03, kHeight)),
                      contact::make_sphere_tool(kToolRadius, 2), params, hand(0));
  };
  Simulation whole = make();
  std::vector<Snapshot> saved;
  for (Tick k = 1; k <= kTicks; ++k) {
    ASSERT_TRUE(whole.tick(hand(k)).is_ok()) << k;
    if (k % kEvery == 0) saved.push_back(whole.take_snapshot());
  }
  for (std::size_t i = 0; i + 2 < saved.size(); ++i) {
    Simulation again = make();
    again.restore(saved[i], "snapshot");
    const Tick end = again.clock().tick + 2 * kEvery;
    for (Tick k = again.clock().tick + 1; k <= end; ++k) ASSERT_TRUE(again.tick(hand(k)).is_ok()) << k;
    const Snapshot last = again.take_snapshot();
    for (const char* name : {"solid/x", "solid/frame"})
      EXPECT_TRUE((last.at(name).array() == saved[i + 2].at(name).array()).all()) << name << ' ' << end;
  }
}

}  // namespace
}  // namespace argil::sim
