// The surface that yields between physics steps: with friction, on a skin, and what it takes from the heap.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/tool_shape.h"
#include "support/heap_count.h"
#include "support/one_node.h"
#include "support/skin_body.h"

namespace argil::sim {
namespace {

constexpr int kPeriod = 14;  // ticks of a physics step

Params make_compliant_params() {
  Params params = test::make_one_node_params();
  params.rates.physics_period_ticks = kPeriod;
  params.rates.between_frames = BetweenFrames::compliant;
  return params;
}

TEST(CompliantFriction, OfASlidingPlateIsCoulombsForHandAndBody) {
  // At a steady depth D the plate presses with k K/(k + K) D and drags by μ times that; the apex gives way
  // aside by the shear stiffness V G |∇N|².
  constexpr double kDepth = 1e-3, kFriction = 0.3, kWay = 2e-5;
  Params params = make_compliant_params();
  params.contact.friction = kFriction;
  const double K = test::compute_apex_stiffness(params.elastic);
  const double nu = params.elastic.poissons_ratio;
  const double aside = K * (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu));  // G over λ + 2μ
  const double normal = test::compute_series(test::kPenalty, K) * kDepth;
  Simulation simulation = test::make_one_node_simulation(params);
  const double x = simulation.body_state().solid.x(0, 3);
  device::DeviceSample sample = test::press_apex(kDepth);
  for (int k = 0; k < 40 * kPeriod; ++k) {
    if (k >= 4 * kPeriod) sample.position.x() += kWay;
    ASSERT_TRUE(simulation.tick(sample).is_ok());
    if (k < 30 * kPeriod) continue;
    const Vec3 felt = simulation.hand_state().hand_force;
    EXPECT_NEAR(felt.z(), normal, 1e-4 * normal) << k;
    EXPECT_NEAR(felt.x(), -kFriction * normal, 1e-3 * normal) << k;
    EXPECT_NEAR(felt.y(), 0.0, 1e-3 * normal) << k;
  }
  EXPECT_NEAR(aside * (simulation.body_state().solid.x(0, 3) - x), kFriction * normal, 1e-3 * normal);
}

/// The surface keeps what pressed it until the body's step, so that this may not be slept through.
TEST(CompliantFidelity, ATouchTooLightToBeFeltWakesTheBodyAllTheSame) {
  Params params = make_compliant_params();
  params.fidelity.mode = FidelityMode::automatic;
  Simulation simulation = test::make_one_node_simulation(params);
  const device::DeviceSample sample = test::press_apex(1e-8);
  for (int step = 1; step <= 4; ++step) {
    for (int k = 0; k < kPeriod; ++k) ASSERT_TRUE(simulation.tick(sample).is_ok());
    EXPECT_GT(simulation.physics_record().active_nodes, 0) << step;
    EXPECT_FALSE(simulation.take_snapshot().empty()) << step;
  }
  const double force = simulation.hand_state().hand_force.norm();
  EXPECT_GT(force, 0.0);
  EXPECT_LT(force, 0.1 * params.fidelity.force_floor);
}

Simulation make_block_simulation(Params params, SurfaceKind kind, double scale) {
  params.contact_surface = kind;
  params.contact.penalty = contact::PenaltyKind::continuous;
  device::DeviceSample start;
  start.position = {0.0211, 0.0197, 0.031};
  return Simulation(test::make_skin_block(scale), contact::make_sphere_tool(0.008, 2), params, start);
}

device::DeviceSample slide(double tip, double aside) {
  device::DeviceSample sample;
  sample.position = {0.0211 + aside, 0.0197, tip + 0.008};
  return sample;
}

TEST(CompliantSkin, ThatIsTheBoundaryItselfGivesTheSameRunAlsoWithFriction) {
  for (const double friction : {0.0, 0.4}) {
    Params params = make_compliant_params();
    params.contact.friction = friction;
    Simulation cage = make_block_simulation(params, SurfaceKind::cage, 1.0);
    Simulation skin = make_block_simulation(params, SurfaceKind::skin, 1.0);
    double largest = 0.0;
    for (int k = 1; k <= 200; ++k) {
      const device::DeviceSample sample = slide(0.023 - 3e-5 * std::min(k, 150), 1e-5 * k);
      ASSERT_TRUE(cage.tick(sample).is_ok() && skin.tick(sample).is_ok());
      largest = std::max(largest, cage.hand_state().hand_force.norm());
      ASSERT_LE((cage.hand_state().hand_force - skin.hand_state().hand_force).norm(), 1e-9 * largest) << k;
    }
    EXPECT_GT(largest, 0.1);
  }
}

TEST(CompliantSkin, UnderTheBoundaryGivesTheBodyWhatTheHandFeels) {
  // Slowly, so that inertia takes nothing: what the base bears is what the hand presses, also aside.
  for (const double friction : {0.0, 0.4}) {
    Params params = make_compliant_params();
    params.contact.friction = friction;
    Simulation simulation = make_block_simulation(params, SurfaceKind::skin, 0.8);
    for (int k = 1; k <= 100 * kPeriod; ++k)
      ASSERT_TRUE(simulation.tick(slide(0.02 - 2e-6 * std::min(k, 1000) - 0.001, 2e-6 * k)).is_ok());
    Vec3 borne = Vec3::Zero();  // by the held nodes of the base
    const Points& internal = simulation.solid().forces.internal;
    for (Eigen::Index v = 0; v < internal.cols(); ++v)
      if (simulation.solid().model.elements.rest(2, v) < 1e-9) borne += internal.col(v);
    const Vec3 felt = simulation.hand_state().hand_force;
    EXPECT_GT(felt.z(), 0.05);
    EXPECT_LT((borne - felt).norm(), 2e-2 * felt.norm()) << borne.transpose() << " | " << felt.transpose();
  }
}

TEST(CompliantGuess, OfVerticesTouchedAnewLiesBetweenNoYieldAndTheBodysOwn) {
  // A node yields less while all others are held: until the first physics step knows the whole answer, the
  // hand feels more than then, and less than the bare penalty.
  const auto press = [](BetweenFrames between, int ticks) {
    Params params = make_compliant_params();
    params.rates.between_frames = between;
    Simulation simulation = make_block_simulation(params, SurfaceKind::cage, 1.0);
    for (int k = 1; k <= ticks; ++k) EXPECT_TRUE(simulation.tick(slide(0.0195, 0.0)).is_ok());
    return simulation.hand_state().hand_force.z();
  };
  const double bare = press(BetweenFrames::re_evaluate, kPeriod - 1);
  const double guessed = press(BetweenFrames::compliant, kPeriod - 1);
  // One that the body has answered to once, in the first step after it was touched.
  const double known = press(BetweenFrames::compliant, kPeriod + 1);
  EXPECT_GT(known, 0.0);
  EXPECT_GT(guessed, known);
  EXPECT_LT(guessed, 0.95 * bare);
}

#ifdef ARGIL_COUNTS_HEAP
TEST(CompliantCost, NoHeapInATickBetweenPhysicsSteps) {
  // Once the lists have grown to what the scene needs.
  for (const double friction : {0.0, 0.4}) {
    Params params = make_compliant_params();
    params.contact.friction = friction;
    Simulation simulation = make_block_simulation(params, SurfaceKind::skin, 0.8);
    std::size_t in_ticks = 0;
    const auto lap = [&](int count) {
      for (int k = 0; k < count * kPeriod; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / (4 * kPeriod);
        const device::DeviceSample sample = slide(0.0165 + 2e-5 * std::sin(angle), 2e-5 * std::cos(angle));
        const std::size_t before = test::count_allocations();
        ASSERT_TRUE(simulation.tick(sample).is_ok());
        if (!simulation.physics_due_last_tick()) in_ticks += test::count_allocations() - before;
      }
    };
    lap(40);
    in_ticks = 0;
    lap(8);
    EXPECT_EQ(in_ticks, 0U) << friction;
    EXPECT_GT(simulation.hand_state().hand_force.z(), 0.05);
  }
}
#endif

}  // namespace
}  // namespace argil::sim
