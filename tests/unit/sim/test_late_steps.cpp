// Steps that the hand does not wait for: what a body gets of ticks that are more or fewer than planned, and
// when the hand sees what became of it.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contact/tool_shape.h"
#include "support/block_mesh.h"
#include "support/one_node.h"

namespace argil::sim {
namespace {

using device::ToolMode;
using test::kPenalty;
using test::press_apex;

/// When a step begins and how many ticks later it is seen.
struct Pace {
  int ticks_a_step = 4;
  int late = 1;
  /// Of tick k, from 0.
  TickPlan plan(int k) const {
    const int since = (k + 1) % ticks_a_step;
    return {k >= ticks_a_step - 1 + late && since == late % ticks_a_step, since == 0};
  }
};

Params make_params(BetweenFrames between_frames) {
  Params params = test::make_one_node_params();
  params.rates.physics_period_ticks = 4;
  params.rates.water_period_ticks = 8;
  params.rates.between_frames = between_frames;
  return params;
}

TEST(LateSteps, BodyAndPenaltyComeToTheBalanceOfTheirSeriesAtAnyPace) {
  // A nearly massless body follows in one step: f = kK/(k + K) · depth, whatever a step has gathered.
  constexpr double kDepth = 5e-4;
  for (const BetweenFrames way : {BetweenFrames::hold, BetweenFrames::re_evaluate})
    for (const Pace pace : {Pace{4, 1}, Pace{4, 3}, Pace{1, 1}, Pace{9, 5}}) {
      const Params params = make_params(way);
      Simulation simulation = test::make_one_node_simulation(params);
      for (int k = 0; k < 600; ++k) ASSERT_TRUE(simulation.tick(press_apex(kDepth), pace.plan(k)).is_ok());
      const double series =
          test::compute_series(kPenalty, test::compute_apex_stiffness(params.elastic)) * kDepth;
      EXPECT_NEAR(simulation.hand_state().hand_force.z(), series, 1e-3 * series)
          << pace.ticks_a_step << " " << pace.late;
    }
}

TEST(LateSteps, FreeBodyTakesUpTheMeanForceOfTheTicksForOneStep) {
  // Σ m v = −Σ h · (mean of the ticks' forces) with a step h that is the same however many ticks it took to
  // come.
  constexpr double kRadius = 0.008;
  Params params;
  params.elastic = {1e5, 0.3};
  params.plasticity.enabled = false;
  params.kernel.form = material::KernelForm::off;
  params.contact.vertex_face_stiffness = 50.0;
  params.contact.edge_edge_stiffness = 50.0;
  params.solid.solver.kind = linear::SolverKind::cholesky;
  params.solid.implicit_contact = false;
  params.rates.physics_period_ticks = 4;
  params.rates.water_period_ticks = 4;
  params.rates.between_frames = BetweenFrames::re_evaluate;
  const auto over = [](double gap) {
    device::DeviceSample sample;
    sample.position = {0.0211, 0.0197, 0.02 + kRadius + gap};
    return sample;
  };
  Body body;
  body.mesh = test::make_block(6, 6, 3, Vec3(0.04, 0.04, 0.02));
  body.topology = mesh::make_topology(body.mesh);
  body.initial_saturation = Field::Zero(body.mesh.num_tets());
  Simulation simulation(std::move(body), contact::make_sphere_tool(kRadius, 2), params, over(0.001));
  Vec3 impulse = Vec3::Zero(), gathered = Vec3::Zero();
  int ticks = 0, steps = 0;
  const std::vector<int> lengths = {4, 7, 4, 1, 2, 11, 4, 5, 4, 4};  // of the steps in ticks
  for (int k = 0; steps < 10; ++k) {
    TickPlan plan;
    plan.receives_step = steps > 0 && ticks == 0;
    plan.begins_step = ticks + 1 == lengths[static_cast<std::size_t>(steps)];
    ASSERT_TRUE(simulation.tick(over(0.001 - 5e-5 * k), plan).is_ok());
    gathered -= simulation.hand_state().hand_force;
    ++ticks;
    if (!plan.begins_step) continue;
    impulse += 0.004 * gathered / ticks;
    gathered.setZero();
    ticks = 0;
    ++steps;
  }
  const Vec3 momentum = simulation.body_state().solid.v * simulation.solid().materials.mass();
  EXPECT_LT(momentum.z(), -1e-5);
  EXPECT_LT((momentum - impulse).norm(), 1e-12 * impulse.norm());
}

TEST(LateSteps, HeldForceFallsByWhatTheBodyYieldsWhenThatIsSeen) {
  constexpr double kDepth = 5e-4;
  const Params params = make_params(BetweenFrames::hold);
  Simulation simulation = test::make_one_node_simulation(params);
  const auto force = [&](const TickPlan& plan) {
    EXPECT_TRUE(simulation.tick(press_apex(kDepth), plan).is_ok());
    return simulation.hand_state().hand_force.z();
  };
  EXPECT_EQ(force({}), 0.0);  // `hold` detects once a step
  EXPECT_NEAR(force({false, true}), kPenalty * kDepth, 1e-12);
  EXPECT_NEAR(force({}), kPenalty * kDepth, 1e-12);
  EXPECT_EQ(simulation.hand_state().force_age, 1);
  const double series = test::compute_series(kPenalty, test::compute_apex_stiffness(params.elastic)) * kDepth;
  EXPECT_NEAR(force({true, false}), series, 1e-4 * series);
}

TEST(LateSteps, AnAnswerDoesNotUndoWhatTheHandHasFeltSince) {
  const Params params = make_params(BetweenFrames::re_evaluate);
  Simulation simulation = test::make_one_node_simulation(params);
  constexpr double kDepth = 5e-4;
  ASSERT_TRUE(simulation.tick(press_apex(kDepth), {false, true}).is_ok());
  // The hand is away again before the step is seen: nothing presses.
  ASSERT_TRUE(simulation.tick(press_apex(-1e-3), {}).is_ok());
  ASSERT_TRUE(simulation.tick(press_apex(-1e-3), {}).is_ok());
  ASSERT_TRUE(simulation.tick(press_apex(-1e-3), {true, false}).is_ok());
  EXPECT_EQ(simulation.hand_state().hand_force.norm(), 0.0);
}

TEST(LateSteps, BodyThatIsStalledIsFeltAsItWas) {
  const Params params = make_params(BetweenFrames::re_evaluate);
  Simulation simulation = test::make_one_node_simulation(params);
  constexpr double kDepth = 5e-4;
  ASSERT_TRUE(simulation.tick(press_apex(kDepth), {false, true}).is_ok());
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(simulation.tick(press_apex(kDepth), {}).is_ok());
  EXPECT_NEAR(simulation.hand_state().hand_force.z(), kPenalty * kDepth, 1e-12);
}

}  // namespace
}  // namespace argil::sim
