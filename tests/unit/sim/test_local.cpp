// Steps of the region that moves against steps of the whole body: the same where nothing may be left out,
// nearer to it the less may be, and what is left out stays where it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "contact/tool_shape.h"
#include "mesh/sliver.h"
#include "shapes/shapes.h"
#include "sim/simulation.h"
#include "support/block_body.h"

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.006;
constexpr int kTicks = 150;

Params make_params(Extent extent, double tolerance) {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.yield = 0.02;
  p.kernel.form = material::KernelForm::rate;
  p.kernel.radius = 0.02;
  p.contact = {200.0, 200.0};
  p.solid.rayleigh_stiffness = 1e-3;
  p.extent = extent;
  p.solid.region_tolerance = tolerance;
  return p;
}

/// A bar of 0.4 m that lies on its long side.
Body make_bar() {
  return test::make_block_body(80, 4, 3, Vec3(0.4, 0.02, 0.015));
}

/// The same, but with so many nodes that a region is taken unasked.
Body make_long_bar() {
  return test::make_block_body(120, 4, 3, Vec3(0.6, 0.02, 0.015));
}

/// Down on one end of it, up again.
device::DeviceSample hand_at(Tick tick) {
  device::DeviceSample sample;
  const double depth = 3e-5 * std::min<double>(static_cast<double>(tick), 100.0 - static_cast<double>(tick));
  sample.position = {0.0503, 0.0102, 0.015 + kToolRadius + 0.0002 - depth};
  sample.mode = device::ToolMode::push;
  return sample;
}

struct PressRun {
  std::vector<Vec3> force;
  int most_active = 0;
  double mean_active = 0.0;  // over all ticks
  Points x;
};

PressRun run(const Params& params, const Body& body = make_bar(), const Vec3& aside = Vec3::Zero()) {
  const auto hand = [&](Tick tick) {
    device::DeviceSample sample = hand_at(tick);
    sample.position += aside;
    return sample;
  };
  Simulation simulation(body, contact::make_sphere_tool(kToolRadius, 2), params, hand(0));
  PressRun result;
  for (Tick k = 1; k <= kTicks; ++k) {
    const StepStatus status = simulation.tick(hand(k));
    EXPECT_TRUE(status.is_ok()) << k;
    result.force.push_back(simulation.hand_state().hand_force);
    const int active = simulation.physics_record().active_nodes;
    result.most_active = std::max(result.most_active, active);
    result.mean_active += static_cast<double>(active) / kTicks;
  }
  result.x = simulation.body_state().solid.x;
  return result;
}

double largest_difference(const PressRun& a, const PressRun& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.force.size(); ++i)
    largest = std::max(largest, (a.force[i] - b.force[i]).norm());
  return largest;
}

/// What goes the same way for tets of either kind and for laws of small and of large strain.
class LocalExtentOf : public testing::TestWithParam<std::tuple<solid::ElementKind, solid::StrainModel>> {
 protected:
  bool is_quadratic() const { return std::get<0>(GetParam()) == solid::ElementKind::p2; }
  void set_kind(Params& params) const {
    params.solid.element = std::get<0>(GetParam());
    params.solid.model = std::get<1>(GetParam());
    if (params.solid.model == solid::StrainModel::hencky) params.plasticity.max = 0.0;
  }
  Body make_small_bar() const {
    return is_quadratic() ? test::make_block_body(40, 2, 2, Vec3(0.4, 0.02, 0.015)) : make_bar();
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, LocalExtentOf,
                         testing::Combine(testing::Values(solid::ElementKind::p1, solid::ElementKind::p2),
                                          testing::Values(solid::StrainModel::corotational,
                                                          solid::StrainModel::hencky)),
                         [](const auto& kind) {
                           const bool is_quadratic = std::get<0>(kind.param) == solid::ElementKind::p2;
                           return std::string(is_quadratic ? "p2_" : "p1_") +
                                  solid::find_law(std::get<1>(kind.param)).name;
                         });

TEST(LocalExtent, IsTheWholeBodyWhereNothingMayBeLeftOut) {
  Params params = make_params(Extent::whole, 1e-300);
  params.solid.gravity = Vec3(0, 0, -9.81);  // the body does not sleep when the run begins
  const PressRun whole = run(params);
  params.extent = Extent::local;
  const PressRun local = run(params);
  EXPECT_EQ(local.most_active, whole.most_active);
  EXPECT_TRUE((local.x.array() == whole.x.array()).all());
  EXPECT_EQ(largest_difference(local, whole), 0.0);
}

TEST(LocalExtent, ComesNearerToTheWholeTheLessItLeavesOut) {
  const PressRun whole = run(make_params(Extent::whole, 1e-3));
  double peak = 0.0;
  for (const Vec3& force : whole.force) peak = std::max(peak, force.norm());
  ASSERT_GT(peak, 0.1);
  double last = peak;
  int last_active = 0;
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    const PressRun local = run(make_params(Extent::local, tolerance));
    const double error = largest_difference(local, whole);
    EXPECT_LT(error, 0.5 * last) << tolerance;
    EXPECT_GT(local.most_active, last_active) << tolerance;
    last = error;
    last_active = local.most_active;
  }
  EXPECT_LT(last, 2e-3 * peak);
  const PressRun coarse = run(make_params(Extent::local, 0.1));
  EXPECT_LT(coarse.most_active, whole.most_active / 2);
}

TEST(LocalExtent, LeavesTheRestWhereItIsAndSleepsWhenNothingActs) {
  Simulation simulation(make_bar(), contact::make_sphere_tool(kToolRadius, 2),
                        make_params(Extent::local, 0.05), hand_at(0));
  const Points start = simulation.body_state().solid.x;
  for (Tick k = 1; k <= 40; ++k) ASSERT_TRUE(simulation.tick(hand_at(k)).is_ok());
  int moved = 0;
  for (Eigen::Index n = 0; n < start.cols(); ++n)
    moved += simulation.body_state().solid.x.col(n) != start.col(n);
  EXPECT_GT(moved, 0);
  EXPECT_LE(moved, simulation.solid().model.num_free());
  for (Eigen::Index n = 0; n < start.cols(); ++n)
    if (start(0, n) > 0.3) {
      EXPECT_TRUE(simulation.body_state().solid.x.col(n) == start.col(n)) << n;
    }
  for (Tick k = 41; k <= 600; ++k) ASSERT_TRUE(simulation.tick(hand_at(std::min<Tick>(k, 100))).is_ok());
  EXPECT_EQ(simulation.physics_record().active_nodes, 0);
}

/// Records know the sums over what did not move from earlier steps; here all of it is looked at anew.
TEST(LocalExtent, RecordsTheEnergyAndPlasticStrainOfTheWholeBody) {
  Params params = make_params(Extent::local, 0.05);
  params.plasticity.yield = 0.001;
  params.plasticity.creep_per_s = 20.0;
  params.plasticity.max = 0.5;
  Simulation simulation(make_bar(), contact::make_sphere_tool(kToolRadius, 2), params, hand_at(0));
  constexpr double kRoundingAtRest = 1e-24;  // [J]
  double largest_energy = 0.0;
  Field working_array;
  for (Tick k = 1; k <= kTicks; ++k) {
    ASSERT_TRUE(simulation.tick(hand_at(k)).is_ok());
    if (k % 7 == 0) continue;  // a step that no one asks about
    const PhysicsRecord record = simulation.physics_record();
    const TensorField& plastic_strain = simulation.body_state().solid.plastic_strain;
    const double energy =
        solid::compute_elastic_energy(simulation.solid().strained(plastic_strain), working_array);
    EXPECT_NEAR(record.elastic_energy, energy, 1e-12 * energy + kRoundingAtRest) << k;
    EXPECT_DOUBLE_EQ(record.max_plastic_strain, plastic_strain.colwise().norm().maxCoeff()) << k;
    largest_energy = std::max(largest_energy, energy);
  }
  EXPECT_GT(largest_energy, 0.0);
  EXPECT_GT(simulation.physics_record().max_plastic_strain, 0.0);
}

/// The region follows what the hand feels: by the reciprocity of forces and displacements. In an elastic
/// block what is far from the tool yields, too, and is felt.
TEST_P(LocalExtentOf, UnderFidelityKeepsTheForceWithinItsBound) {
  const int cells = is_quadratic() ? 4 : 8;
  const Body block = test::make_block_body(3 * cells, 3 * cells, cells, Vec3(0.12, 0.12, 0.04));
  const Vec3 middle(0.0097, 0.0498, 0.025);
  Params params = make_params(Extent::whole, 1e-3);
  set_kind(params);
  params.plasticity.enabled = false;
  params.kernel.form = material::KernelForm::off;
  const PressRun whole = run(params, block, middle);
  params.fidelity.mode = FidelityMode::automatic;
  params.extent = Extent::automatic;
  const PressRun region = run(params, block, middle);
  double error = 0.0;
  for (std::size_t k = 0; k < whole.force.size(); ++k) {
    const double bound =
        std::max(params.fidelity.force_floor, params.fidelity.force_tolerance * whole.force[k].norm());
    error = std::max(error, (region.force[k] - whole.force[k]).norm() / bound);
  }
  EXPECT_LT(error, 1.0);
  EXPECT_LT(region.mean_active, 0.4 * whole.mean_active);
}

/// A hand that holds still: body and region sleep, and do not wake at every look.
TEST(LocalExtent, UnderFidelitySleepsWhileTheHandHoldsStill) {
  Params params = make_params(Extent::local, 1e-3);
  params.fidelity.mode = FidelityMode::automatic;
  params.plasticity.enabled = false;               // whose flow would go on, and
  params.kernel.form = material::KernelForm::off;  // with which it creeps
  Simulation simulation(make_bar(), contact::make_sphere_tool(kToolRadius, 2), params, hand_at(0));
  int asleep = 0;
  for (Tick k = 1; k <= 400; ++k) {
    ASSERT_TRUE(simulation.tick(hand_at(std::min<Tick>(k, 30))).is_ok());
    if (k <= 300) continue;
    const PhysicsRecord record = simulation.physics_record();
    if (record.fidelity.rung != Rung::asleep) continue;
    EXPECT_EQ(record.active_nodes, 0) << k;
    ++asleep;
  }
  EXPECT_GT(simulation.hand_state().hand_force.norm(), params.fidelity.force_floor);
  EXPECT_GE(asleep, 95);
}

/// What a step leaves of nodes that have fallen asleep may not come back when they wake.
TEST_P(LocalExtentOf, UnderFidelityReturnsToTheSameBits) {
  Params params = make_params(Extent::local, 1e-3);
  set_kind(params);
  params.fidelity.mode = FidelityMode::automatic;
  params.fidelity.force_floor = 0.002;
  const auto make = [&] {
    return Simulation(make_small_bar(), contact::make_sphere_tool(kToolRadius, 2), params, hand_at(0));
  };
  const auto run_on = [](Simulation& simulation, Tick last) {
    while (simulation.clock().tick < last)
      ASSERT_TRUE(simulation.tick(hand_at(simulation.clock().tick + 1)).is_ok());
  };
  Simulation whole = make();
  std::map<Tick, Snapshot> saved;
  for (const Tick at : {15, 40, 60, 80, 95}) {
    run_on(whole, at);
    saved[at] = whole.take_snapshot();
  }
  run_on(whole, kTicks);
  Simulation used = make();
  run_on(used, 70);
  for (const auto& [at, snapshot] : saved) {
    Simulation fresh = make();
    for (Simulation* simulation : {&fresh, &used}) {
      simulation->restore(snapshot, "run.h5");
      run_on(*simulation, kTicks);
      EXPECT_EQ(simulation->state_hash(), whole.state_hash()) << at;
      simulation->restore(saved.at(60), "run.h5");  // from where something has moved to where something has
      run_on(*simulation, 62);
    }
  }
}

/// A flat tet under the tool, beside which floats lose what holds its neighbours: the whole body is solved
/// for then, by a factor, and on return from a checkpoint, too.
TEST(LocalExtent, IsLeftWhereFloatsMakeItsMatrixIndefinite) {
  Body body = test::make_block_body(12, 12, 4, Vec3(0.06, 0.06, 0.02));
  mesh::flatten_tet(body.mesh, 1e-9);
  body.topology = mesh::make_topology(body.mesh);
  const auto hand = [](Tick tick) {
    device::DeviceSample sample;
    sample.position = {0.0303, 0.0302, 0.02 + kToolRadius + 2e-5 - 1e-5 * static_cast<double>(tick)};
    sample.mode = device::ToolMode::push;
    return sample;
  };
  const auto make = [&](Extent extent) {
    return Simulation(body, contact::make_sphere_tool(kToolRadius, 2), make_params(extent, 1e-3), hand(0));
  };
  const auto run_on = [&](Simulation& simulation, Tick last) {
    while (simulation.clock().tick < last) {
      const StepStatus status = simulation.tick(hand(simulation.clock().tick + 1));
      ASSERT_TRUE(status.is_ok()) << to_string(status.failure());
    }
  };
  Simulation local = make(Extent::local);
  const Snapshot before = local.take_snapshot();
  run_on(local, 12);
  EXPECT_EQ(local.physics_record().active_nodes, local.solid().model.num_free());
  EXPECT_EQ(local.physics_record().factorisations, 1);
  const Snapshot after = local.take_snapshot();
  run_on(local, 20);
  EXPECT_GT(local.hand_state().hand_force.norm(), 0.01);
  Simulation whole = make(Extent::whole);
  run_on(whole, 20);
  EXPECT_NEAR((local.hand_state().hand_force - whole.hand_state().hand_force).norm(), 0.0, 1e-3);

  Simulation fresh = make(Extent::local);
  fresh.restore(after, "run.h5");
  run_on(fresh, 20);
  EXPECT_EQ(fresh.state_hash(), local.state_hash());
  fresh.restore(before, "run.h5");  // to where it had its region
  run_on(fresh, 20);
  EXPECT_EQ(fresh.state_hash(), local.state_hash());
}

TEST(LocalExtent, IsTakenByItselfWhereItSaves) {
  Params params = make_params(Extent::automatic, 1e-3);
  const auto count_active = [&](const Body& body) {
    Simulation simulation(body, contact::make_sphere_tool(kToolRadius, 2), params, hand_at(0));
    for (Tick k = 1; k <= 10; ++k) EXPECT_TRUE(simulation.tick(hand_at(k)).is_ok());
    return std::pair(simulation.physics_record().active_nodes, simulation.solid().model.num_free());
  };
  const auto [in_full, all] = count_active(make_long_bar());
  EXPECT_EQ(in_full, all);
  params.fidelity.mode = FidelityMode::automatic;
  const auto [in_auto, again] = count_active(make_long_bar());
  EXPECT_LT(in_auto, again);
  const auto [in_small, of_small] = count_active(test::make_block_body(20, 4, 3, Vec3(0.1, 0.02, 0.015)));
  EXPECT_EQ(in_small, of_small);
}

TEST_P(LocalExtentOf, GivesEqualBitsOnAnyNumberOfThreads) {
  for (const FidelityMode mode : {FidelityMode::full, FidelityMode::automatic}) {
    Params params = make_params(Extent::local, 0.02);
    set_kind(params);
    params.fidelity.mode = mode;
    const PressRun one = run(params, make_small_bar());
    for (const int threads : {2, 3}) {
      params.threads = threads;
      const PressRun more = run(params, make_small_bar());
      EXPECT_TRUE((more.x.array() == one.x.array()).all()) << threads;
      EXPECT_EQ(more.most_active, one.most_active);
    }
  }
}

}  // namespace
}  // namespace argil::sim
