// What the hand feels, against closed forms of a body that moves in one node.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "support/one_node.h"

namespace argil::sim {
namespace {

using device::ToolMode;
using test::kPenalty;
using test::press_apex;

/// Goes to `depth` and keeps going: force along z and the energy given to the hand.
HapticRecord go_to(Simulation& simulation, double depth, ToolMode mode = ToolMode::push) {
  EXPECT_TRUE(simulation.tick(press_apex(depth, mode)).is_ok());
  return simulation.haptic_record();
}

TEST(HandForce, OfAWallIsPenaltyTimesDepth) {
  // A tool that does not deform the body meets a wall.
  Simulation simulation = test::make_one_node_simulation(test::make_one_node_params());
  for (const double depth : {-1e-4, 1e-4, 5e-4, 2e-4})
    EXPECT_NEAR(go_to(simulation, depth, ToolMode::dry).force.z(), kPenalty * std::max(0.0, depth), 1e-12);
  EXPECT_EQ(simulation.haptic_record().num_contacts, 1);
}

TEST(HandForce, OfAnElasticBodyIsThatOfTwoSpringsInSeriesAtOnce) {
  // The step finds how far the body yields, and the hand feels it: no force of the surface as it was.
  const Params params = test::make_one_node_params();
  const double K = test::compute_apex_stiffness(params.elastic);
  const double series = test::compute_series(kPenalty, K);
  Simulation simulation = test::make_one_node_simulation(params);
  for (const double depth : {1e-4, 5e-4, 9e-4, 7e-4})
    EXPECT_NEAR(go_to(simulation, depth).force.z(), series * depth, 1e-5 * series * depth) << depth;
}

TEST(HandForce, IsTheOppositeOfWhatActedOnTheBody) {
  // Work on the body is Σ force · displacement of the apex; the paper's hand feels the surface as it was.
  for (const bool implicit : {true, false}) {
    Params params = test::make_one_node_params();
    params.solid.implicit_contact = implicit;
    params.solid.density = 1500.0;
    Simulation simulation = test::make_one_node_simulation(params);
    double z = test::kHeight;
    double work = 0.0;
    for (int k = 1; k <= 50; ++k) {
      const double force = go_to(simulation, 1e-5 * k).force.z();
      const double z_next = simulation.body_state().solid.x(2, 3);
      work += force * (z - z_next);
      z = z_next;
      EXPECT_NEAR(simulation.body_state().contact_work, work, 1e-15);
    }
    EXPECT_GT(work, 1e-7);
  }
}

TEST(HandForce, NeverDrawsOnABodyThatLeaves) {
  // A mass m on a spring K that the plate presses by k and that flies ahead of it, or that the plate leaves:
  // m (v' − v)/h = max(0, f − k (d' − d)) − K d', d' = d + h v', f = k (D − d) at the depth D of the plate.
  // A force that fell in proportion would draw in such steps.
  Params params = test::make_one_node_params();
  params.chatter_limit = 1.0;  // it is the hand that trembles
  const double K = test::compute_apex_stiffness(params.elastic);
  for (const int period : {1, 14}) {
    params.rates.physics_period_ticks = period;
    params.solid.density = 7e3 * period * period;  // the penalty's frequency is about half a radian a step
    const double h = 1e-3 * period;
    Simulation simulation = test::make_one_node_simulation(params);
    const double m = simulation.solid().materials.mass()(3);
    double d = 0.0, v = 0.0;
    int num_let_go = 0, num_pressing = 0;
    for (int frame = 1; frame <= 3000; ++frame) {
      const double depth = 4e-4 * (1.0 + std::sin(2.3 * frame) + std::sin(0.11 * frame * frame));
      for (int k = 0; k < period; ++k) go_to(simulation, depth);
      const double before = kPenalty * std::max(0.0, depth - d);
      const double pressed = before > 0.0 ? before + kPenalty * d : 0.0;  // force at d' = 0
      const double stiffness = before > 0.0 ? kPenalty : 0.0;
      double v_next = (m * v + h * (pressed - (K + stiffness) * d)) / (m + h * h * (K + stiffness));
      double force = pressed - stiffness * (d + h * v_next);
      if (force < 0.0) {
        ++num_let_go;
        v_next = (m * v - h * K * d) / (m + h * h * K);
        force = 0.0;
      }
      num_pressing += force > 0.0 ? 1 : 0;
      v = v_next;
      d += h * v;
      ASSERT_NEAR(simulation.hand_state().hand_force.z(), force, 1e-6) << frame;
      ASSERT_NEAR(test::kHeight - simulation.body_state().solid.x(2, 3), d, 1e-9) << frame;
      ASSERT_GE(simulation.hand_state().hand_force.z(), -1e-15);
    }
    EXPECT_GT(num_let_go, 10);
    EXPECT_GT(num_pressing, 1000);
  }
}

/// Largest change of the force for changes of `step` of how far the hand draws back in one tick, at up to
/// 1.5 times the depth, from rest at that depth.
double find_largest_jump(const Params& params, double depth, double step) {
  double largest = 0.0, last = 0.0;
  for (double back = 0.0; back <= 1.5 * depth; back += step) {
    Simulation simulation = test::make_one_node_simulation(params);
    for (int k = 0; k < 4 * params.rates.physics_period_ticks; ++k) go_to(simulation, depth);
    const double force = go_to(simulation, depth - back).force.z();
    if (back > 0.0) largest = std::max(largest, std::abs(force - last));
    last = force;
  }
  return largest;
}

TEST(HandForce, IsContinuousInHowFarTheHandDrawsBackButForTheDiscretePenalty) {
  // A penalty k presses as far as f/k deep. A hand that draws back farther in one tick than that is ahead of
  // the surface, which follows only in the next step: it feels nothing for a tick where the surface stands
  // still (re_evaluate), fades out where the force is the mean over the way (continuous), and loses at once,
  // K k/(K + k) (D − f/k), what the step would have added to it where the place at the end alone counts.
  constexpr double kDepth = 1e-3;
  struct Case {
    BetweenFrames between;
    int period;
    contact::PenaltyKind penalty;
  };
  for (const auto& [between, period, penalty] :
       {Case{BetweenFrames::hold, 1, contact::PenaltyKind::continuous},
        Case{BetweenFrames::re_evaluate, 14, contact::PenaltyKind::continuous},
        Case{BetweenFrames::re_evaluate, 14, contact::PenaltyKind::discrete},
        Case{BetweenFrames::compliant, 14, contact::PenaltyKind::discrete},
        Case{BetweenFrames::hold, 1, contact::PenaltyKind::discrete}}) {
    Params params = test::make_one_node_params();
    params.rates.between_frames = between;
    params.rates.physics_period_ticks = period;
    params.contact.penalty = penalty;
    const double coarse = find_largest_jump(params, kDepth, 2e-5);
    const double fine = find_largest_jump(params, kDepth, 1e-5);
    if (between == BetweenFrames::hold && penalty == contact::PenaltyKind::discrete) {
      const double K = test::compute_apex_stiffness(params.elastic);
      const double series = test::compute_series(kPenalty, K);
      EXPECT_NEAR(fine, series * kDepth * (1.0 - series / kPenalty), series * 2e-5);
    } else {
      EXPECT_LT(coarse, 2.0 * kPenalty * 2e-5) << static_cast<int>(between);
      EXPECT_LT(fine, 0.6 * coarse) << static_cast<int>(between);
    }
  }
}

TEST(Compliant, IsTwoSpringsInSeriesBetweenPhysicsSteps) {
  // Of the apex's stiffness K and the penalty k, whatever the hand does between two physics steps, also when
  // it draws back faster than the penalty alone reaches. Against the surface as it was: k on top of the last
  // force.
  Params params = test::make_one_node_params();
  params.rates.physics_period_ticks = 14;
  const double K = test::compute_apex_stiffness(params.elastic);
  const double series = test::compute_series(kPenalty, K);
  for (const BetweenFrames between : {BetweenFrames::compliant, BetweenFrames::re_evaluate}) {
    params.rates.between_frames = between;
    Simulation simulation = test::make_one_node_simulation(params);
    for (int k = 0; k < 56; ++k) go_to(simulation, 1e-3);
    EXPECT_NEAR(simulation.hand_state().hand_force.z(), series * 1e-3, 1e-5 * series * 1e-3);
    for (const double change : {1e-5, 1e-4, 5e-4, -2e-4, -9e-4, 3e-4, -2e-3, 2e-4}) {
      const double wanted = between == BetweenFrames::compliant
                                ? series * std::max(0.0, 1e-3 + change)
                                : std::max(0.0, series * 1e-3 + kPenalty * change);
      EXPECT_NEAR(go_to(simulation, 1e-3 + change).force.z(), wanted, 1e-5 * series * 1e-3) << change;
    }
  }
}

TEST(Compliant, GivesTheBodyTheMeanOfWhatTheHandFeels) {
  // Elastic and without mass: the apex is where the mean force of the last 14 ticks holds it.
  Params params = test::make_one_node_params();
  params.rates.physics_period_ticks = 14;
  params.rates.between_frames = BetweenFrames::compliant;
  const double K = test::compute_apex_stiffness(params.elastic);
  Simulation simulation = test::make_one_node_simulation(params);
  for (int frame = 0; frame < 6; ++frame) {
    double mean = 0.0;
    for (int k = 1; k <= 14; ++k)
      mean += go_to(simulation, 2e-4 * frame + 1e-5 * k * (frame < 4 ? 1 : -3)).force.z() / 14.0;
    const double depth = test::kHeight - simulation.body_state().solid.x(2, 3);
    EXPECT_NEAR(K * depth, mean, 1e-4 * mean) << frame;
  }
}

TEST(Compliant, DoesNotYieldToToolsThatDoNotDeformTheBody) {
  Params params = test::make_one_node_params();
  params.rates.physics_period_ticks = 14;
  params.rates.between_frames = BetweenFrames::compliant;
  Simulation simulation = test::make_one_node_simulation(params);
  for (int k = 0; k < 40; ++k) go_to(simulation, 3e-4);
  for (int k = 0; k < 40; ++k) go_to(simulation, 3e-4, ToolMode::wet);
  EXPECT_NEAR(simulation.hand_state().hand_force.z(), kPenalty * 3e-4, 1e-9);
  EXPECT_LT(std::abs(simulation.body_state().solid.x(2, 3) - test::kHeight), 1e-9);
}

/// Energy that the hand is given in the last of three cycles of depth + amplitude·cos.
double find_energy_of_cycle(const Params& params, double amplitude, int ticks, ToolMode mode) {
  Simulation simulation = test::make_one_node_simulation(params);
  double before = 0.0;
  HapticRecord record;
  for (int k = 1; k <= 3 * ticks; ++k) {
    const double phase = 2.0 * std::numbers::pi * (k % ticks) / ticks;
    record = go_to(simulation, 3.0 * amplitude + amplitude * std::cos(phase), mode);
    if (k == 2 * ticks) before = record.port_energy;
  }
  return record.port_energy - before;
}

TEST(PortEnergy, OfAHeldSpringIsThatOfItsDelay) {
  // A spring K sampled every T seconds and held, on a sine with φ = ωT: Σ F·Δx over a cycle is
  // πKA² sin²(φ/2)/(φ/2), which a delay of T/2 brings. The mean over the motion is late by another T/2:
  // πKA² sin²(φ)/φ.
  constexpr double kAmplitude = 2e-4;
  constexpr int kFrames = 12;
  const double phi = 2.0 * std::numbers::pi / kFrames;
  const double scale = std::numbers::pi * kPenalty * kAmplitude * kAmplitude;
  for (const int period : {1, 14}) {
    Params params = test::make_one_node_params();
    params.rates.physics_period_ticks = period;
    const double held = find_energy_of_cycle(params, kAmplitude, kFrames * period, ToolMode::dry);
    EXPECT_NEAR(held, scale * std::pow(std::sin(phi / 2.0), 2) / (phi / 2.0), 1e-9 * scale);
    if (period > 1) continue;  // over 14 ticks the mean is along the chord
    params.contact.penalty = contact::PenaltyKind::continuous;
    const double mean = find_energy_of_cycle(params, kAmplitude, kFrames, ToolMode::dry);
    EXPECT_NEAR(mean, scale * std::pow(std::sin(phi), 2) / phi, 1e-9 * scale);
  }
}

/// Presses `depth` deep and lets go in 2·steps ticks; the last record, and the lowest energy on the way.
HapticRecord press_and_release(Simulation& simulation, double depth, int steps, double& lowest) {
  HapticRecord record;
  lowest = 0.0;
  for (int k = 0; k <= 2 * steps + 1; ++k) {
    record = go_to(simulation, depth * std::min(k, 2 * steps - k) / steps);
    lowest = std::min(lowest, record.port_energy);
  }
  return record;
}

TEST(PortEnergy, OfASlowElasticPressComesBack) {
  // ½ K X² goes in and comes out; the held force makes K X Δ, one tick's way Δ, besides. The plate leaves the
  // surface as it last was a tick early, with K Δ² of it.
  const Params params = test::make_one_node_params();
  const double K = test::compute_series(kPenalty, test::compute_apex_stiffness(params.elastic));
  constexpr double kDepth = 1e-3;
  const double stored = 0.5 * K * kDepth * kDepth;
  for (const int steps : {100, 1000}) {
    Simulation simulation = test::make_one_node_simulation(params);
    double lowest = 0.0;
    const HapticRecord record = press_and_release(simulation, kDepth, steps, lowest);
    EXPECT_NEAR(record.port_energy, 2.0 * stored / steps, 1e-5 * stored + 2.0 * stored / (steps * steps));
    EXPECT_NEAR(lowest, -stored * (1.0 - 1.0 / steps), 1e-5 * stored);
  }
}

TEST(PortEnergy, OfAPlasticPressIsLostToTheClay) {
  // What the hand gave is dissipated or left in the body: nothing else takes energy in a slow press.
  Params params = test::make_one_node_params();
  params.plasticity.enabled = true;
  params.plasticity.form = material::FlowForm::j2;
  params.plasticity.yield = 0.01;
  params.plasticity.max = 1.0;
  Simulation simulation = test::make_one_node_simulation(params);
  double lowest = 0.0;
  const HapticRecord record = press_and_release(simulation, 2e-3, 4000, lowest);
  const PhysicsRecord body = simulation.physics_record();
  EXPECT_GT(body.plastic_dissipation, -0.1 * lowest);
  EXPECT_NEAR(-record.port_energy, body.plastic_dissipation + body.elastic_energy, -0.01 * lowest);
}

TEST(HandForce, ThatTremblesEndsTheRun) {
  // A force of the surface as it was, on a body without inertia: u ← k (d − u)/K, whose next error is the
  // last one times −k/K. It swings ever wider from k = K on, and dies out below.
  for (const auto& [ratio, implicit, ends] :
       {std::tuple(0.8, false, false), {1.2, false, true}, {10.0, true, false}}) {
    Params params = test::make_one_node_params();
    params.solid.implicit_contact = implicit;
    params.contact.vertex_face_stiffness = ratio * test::compute_apex_stiffness(params.elastic);
    params.energy_limit = 0.0;
    Simulation simulation = test::make_one_node_simulation(params);
    StepStatus status = StepStatus::ok();
    int k = 0;
    while (status.is_ok() && ++k <= 2000) status = simulation.tick(press_apex(1e-4));
    ASSERT_EQ(status.is_ok(), !ends) << ratio;
    if (!ends) continue;
    EXPECT_EQ(status.failure().stage, "hand");
    EXPECT_EQ(status.failure().tick, k);
    EXPECT_LE(k, 420);
    EXPECT_GT(status.failure().value, 0.3);
    EXPECT_EQ(status.failure().bound, 0.3);
    EXPECT_EQ(simulation.clock().tick, k - 1);  // the last good one
  }
}

}  // namespace
}  // namespace argil::sim
