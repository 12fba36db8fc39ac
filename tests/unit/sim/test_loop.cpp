// What a tick makes of the laws it calls: each with its own step, in its own period, on the right body.
// Expected values are closed forms of one tet, beside which a second tet hangs.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/one_node.h"

namespace argil::sim {
namespace {

using device::ToolMode;
using test::kEdge;
using test::kHeight;
using test::kPenalty;
using test::press_apex;

constexpr int kApex = 3;
constexpr int kFar = 4;
constexpr double kTick = 0.001;  // [s]

/// The body of one tet, and a second one on its side whose fourth node is free and out of the plate's reach.
Body make_two_tets() {
  Body body = test::make_one_node_body();
  body.mesh.vertices.conservativeResize(3, 5);
  body.mesh.vertices.col(kFar) << 0.5 * kEdge, -0.01, 0.6 * kHeight;
  body.mesh.tets.conservativeResize(4, 2);
  body.mesh.tets.col(1) << 0, 1, kApex, kFar;
  body.topology = mesh::make_topology(body.mesh);
  body.initial_saturation = Field::Zero(2);
  return body;
}

Simulation make_simulation(const Params& params, Body body = make_two_tets()) {
  return {std::move(body), test::make_plate_tool(), params, press_apex(-1e-3)};
}

/// As many ticks at one place.
void stay(Simulation& simulation, const device::DeviceSample& sample, int ticks) {
  for (int k = 0; k < ticks; ++k) ASSERT_TRUE(simulation.tick(sample).is_ok());
}

/// Speed of the far node after the first pressed physics step, over what it is without a kernel.
double find_kernel_ratio(material::ClayKernel kernel, int period_ticks) {
  double speed[2] = {};
  for (const bool has_kernel : {false, true}) {
    Params params = test::make_one_node_params();
    params.solid.density = 1500.0;
    params.rates.physics_period_ticks = period_ticks;
    if (has_kernel) params.kernel = kernel;
    Simulation simulation = make_simulation(params);
    stay(simulation, press_apex(5e-4), period_ticks);
    speed[has_kernel] = simulation.body_state().solid.v.col(kFar).norm();
  }
  EXPECT_GT(speed[0], 1e-6);
  return speed[1] / speed[0];
}

TEST(Loop, KernelScalesVelocitiesByItsWeightAtTheDistanceFromTheContact) {
  // Eq. 9: G_d = 1/(1 + k₁r) within R_D, 1/(1 + k₁r + e^{k₂r}) beyond; v ← G_d^{h/h_ref} v. The plate touches
  // the apex alone.
  const Points x = make_two_tets().mesh.vertices;
  const double r = (x.col(kFar) - x.col(kApex)).norm();
  const double k1 = 30.0;
  const double k2 = 50.0;
  material::ClayKernel kernel{material::KernelForm::rate, k1, k2, 0.0, 0.014};
  for (const bool is_near : {true, false}) {
    kernel.radius = is_near ? 1.1 * r : 0.9 * r;
    const double weight = 1.0 / (1.0 + k1 * r + (is_near ? 0.0 : std::exp(k2 * r)));
    for (const int period : {1, 2}) {
      kernel.form = material::KernelForm::rate;
      EXPECT_NEAR(find_kernel_ratio(kernel, period), std::pow(weight, period * kTick / 0.014), 1e-12);
      kernel.form = material::KernelForm::per_step;  // the paper's: once a step, however long
      EXPECT_NEAR(find_kernel_ratio(kernel, period), weight, 1e-12);
    }
  }
}

TEST(Loop, KernelLeavesABodyFreeThatNothingPresses) {
  Params params = test::make_one_node_params();
  params.solid.gravity = {0.0, 0.0, -10.0};
  Simulation free = make_simulation(params);
  params.kernel = {material::KernelForm::per_step, 30.0, 50.0, 0.01, 0.014};
  Simulation with_kernel = make_simulation(params);
  stay(free, press_apex(-1e-3), 3);
  stay(with_kernel, press_apex(-1e-3), 3);
  EXPECT_GT(free.body_state().solid.v.norm(), 0.0);
  EXPECT_EQ(with_kernel.body_state().solid.v, free.body_state().solid.v);
}

TEST(Loop, HeldStrainFlowsAtItsRateWhateverThePeriod) {
  // ε = δ/H along z in the first tet, held; [Mueller2004] in rate form: ε_p = (1 − e^{−ct}) ε.
  constexpr double kCreep = 40.0;  // [1/s]
  constexpr double kPull = 4e-4;   // δ [m]
  for (const int period : {1, 4}) {
    Params params = test::make_one_node_params();
    params.rates.physics_period_ticks = period;
    params.plasticity.enabled = true;
    params.plasticity.yield = 1e-9;
    params.plasticity.creep_per_s = kCreep;
    params.plasticity.max = 1.0;
    params.plasticity.deviatoric = false;
    Body body = make_two_tets();
    solid::Support apex;
    apex.region.kind = solid::Region::Kind::nodes;
    apex.region.nodes = {kApex};
    apex.displacement = {0.0, 0.0, kPull};
    body.supports.push_back(apex);
    Simulation simulation = make_simulation(params, std::move(body));
    for (int k = 1; k <= 5; ++k) {
      stay(simulation, press_apex(-1e-3), period);
      Vec6 expected = Vec6::Zero();
      expected(2) = -std::expm1(-kCreep * k * period * kTick) * kPull / kHeight;
      const Vec6 plastic = simulation.body_state().solid.plastic_strain.col(0);
      EXPECT_LT((plastic - expected).norm(), 1e-12 * expected.norm()) << k;
    }
  }
}

TEST(Loop, DeviceForceIsTheHandsForceWithinTheDevicesLimit) {
  // A turned plate on a wall: the force is along its normal and longer than the device can render.
  constexpr double kMaxForce = 0.1;  // [N]
  Params params = test::make_one_node_params();
  params.device.max_force = kMaxForce;
  Simulation simulation = make_simulation(params);
  device::DeviceSample sample = press_apex(6e-4, ToolMode::dry);
  sample.orientation = Eigen::AngleAxisd(0.1, Vec3(2.0, -1.0, 0.0).normalized());
  stay(simulation, sample, 1);
  const Vec3 normal = sample.orientation * Vec3::UnitZ();
  const Vec3 apex(0.5 * kEdge, kEdge / (2.0 * std::sqrt(3.0)), kHeight);
  const double force = kPenalty * normal.dot(apex - sample.position);
  ASSERT_GT(force, 1.5 * kMaxForce);
  const HapticRecord record = simulation.haptic_record();
  EXPECT_LT((record.force - force * normal).norm(), 1e-12);
  EXPECT_LT((record.device_force - kMaxForce * normal).norm(), 1e-12);
}

TEST(Loop, PullReversesForceAndTorque) {
  // The force K·depth acts in the apex; the torque is about the hand's point.
  constexpr double kDepth = 4e-4;
  Params params = test::make_one_node_params();
  params.solid.implicit_contact = false;  // else the push falls while the surface yields
  const Vec3 apex(0.5 * kEdge, kEdge / (2.0 * std::sqrt(3.0)), kHeight);
  for (const ToolMode mode : {ToolMode::push, ToolMode::pull}) {
    Simulation simulation = make_simulation(params);
    const device::DeviceSample sample = press_apex(kDepth, mode);
    stay(simulation, sample, 1);
    const Vec3 force = (mode == ToolMode::pull ? -1.0 : 1.0) * kPenalty * kDepth * Vec3::UnitZ();
    EXPECT_LT((simulation.hand_state().hand_force - force).norm(), 1e-12);
    const Vec3 torque = (apex - sample.position).cross(force);
    EXPECT_LT((simulation.hand_state().hand_torque - torque).norm(), 1e-12 * torque.norm());
  }
}

TEST(Loop, SkinTakesTheSaturationOfTheTetThatHoldsIt) {
  Body body = make_two_tets();
  body.initial_saturation << 0.25, 0.75;
  body.skin.vertices.resize(3, 3);
  for (int v = 0; v < 3; ++v) {
    Vec3 inside = Vec3::Zero();
    for (int c = 0; c < 4; ++c)
      inside += (c == v ? 0.4 : 0.2) * body.mesh.vertices.col(body.mesh.tets(c, v == 1 ? 0 : 1));
    body.skin.vertices.col(v) = inside;
  }
  body.skin.triangles.resize(3, 1);
  body.skin.triangles << 0, 1, 2;
  body.skin_embedding = embed::make_embedding(body.mesh, body.skin.vertices, "two tets");
  const Frame frame = make_simulation(test::make_one_node_params(), std::move(body)).make_frame();
  ASSERT_EQ(frame.skin_saturation.size(), 3);
  EXPECT_EQ(frame.skin_saturation(0), 0.75);
  EXPECT_EQ(frame.skin_saturation(1), 0.25);
  EXPECT_EQ(frame.skin_saturation(2), 0.75);
}

TEST(Loop, PhysicsStepsOnceInItsPeriodByAllOfIt) {
  // Free fall by backward Euler: after m steps of h, v = −m g h and z = z₀ − ½ m (m+1) g h².
  constexpr double kGravity = 10.0;
  constexpr int kPeriod = 3;
  Params params = test::make_one_node_params();
  params.solid.gravity = {0.0, 0.0, -kGravity};
  params.solid.density = 1500.0;
  params.rates.physics_period_ticks = kPeriod;
  Body body = make_two_tets();
  body.supports.clear();
  Simulation simulation = make_simulation(params, std::move(body));
  const double h = kPeriod * kTick;
  for (int k = 1; k <= 14; ++k) {
    stay(simulation, press_apex(-1e-2), 1);
    const int m = k / kPeriod;
    EXPECT_NEAR(simulation.body_state().solid.v(2, kApex), -m * kGravity * h, 1e-12) << k;
    EXPECT_NEAR(simulation.body_state().solid.x(2, kApex), kHeight - 0.5 * m * (m + 1) * kGravity * h * h,
                1e-14);
  }
}

TEST(Loop, WaterStepsOnceInItsPeriodByAllOfIt) {
  // m = q A t at every water step; a wet tool leaves the body where it is, so that A stays.
  constexpr double kFlux = 0.5;  // q [kg/(m² s)]
  constexpr int kPeriod = 4;
  Params params = test::make_one_node_params();
  params.rates.water_period_ticks = kPeriod;
  params.water.wetting_flux = kFlux;
  Simulation simulation = make_simulation(params);
  double area = 0.0;  // found when water is due alone
  for (int k = 1; k <= 14; ++k) {
    stay(simulation, press_apex(2e-3, ToolMode::wet), 1);
    const std::vector<double>& touched = simulation.contacts().touched_area;
    if (k % kPeriod == 0) area = std::accumulate(touched.begin(), touched.end(), 0.0);
    ASSERT_EQ(area > 1e-7, k >= kPeriod);
    const double expected = kFlux * area * (k / kPeriod) * kPeriod * kTick;
    EXPECT_NEAR(simulation.pore_water().ledger().added, expected, 1e-12 * expected) << k;
  }
  EXPECT_LT(simulation.pore_water().saturation().maxCoeff(), 1.0);
}

}  // namespace
}  // namespace argil::sim
