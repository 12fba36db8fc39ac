// What a whole tick takes from the heap once its lists have grown to what the scene needs: nothing.
#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"
#include "support/heap_count.h"

#ifdef ARGIL_COUNTS_HEAP

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.006;
constexpr int kPeriod = 20;  // ticks of a round

Params make_params() {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.yield = 0.02;
  p.plasticity.creep_per_s = 20.0;
  p.plasticity.max = 0.5;
  p.kernel.form = material::KernelForm::rate;
  p.kernel.k1 = 2.0;
  p.kernel.k2 = 60.0;
  p.kernel.radius = 0.02;
  p.contact = {200.0, 200.0};
  p.contact.friction = 0.3;
  p.solid.rayleigh_stiffness = 1e-3;
  p.rates.water_period_ticks = 10;
  p.water.diffusivity = 5e-6;
  p.water.wetting_flux = 1.0;
  return p;
}

Body make_block_body() {
  return test::make_block_body(6, 6, 4, Vec3(0.03, 0.03, 0.02), 0.2);
}

/// A small round on the top, pressed in.
device::DeviceSample hand_at(int tick, device::ToolMode mode) {
  const double angle = 2.0 * std::numbers::pi * tick / kPeriod;
  device::DeviceSample sample;
  sample.position = {0.0153 + 2e-4 * std::sin(angle), 0.0152 + 2e-4 * std::cos(angle),
                     0.02 + kToolRadius - 4e-4 + 1e-4 * std::sin(angle)};
  sample.mode = mode;
  return sample;
}

/// Allocations of five rounds after fifteen.
std::size_t count_in_ticks(const Params& params, device::ToolMode mode) {
  device::DeviceSample away = hand_at(0, mode);
  away.position.z() += 0.002;
  Simulation simulation(make_block_body(), contact::make_sphere_tool(kToolRadius, 2), params, away);
  std::size_t in_ticks = 0;
  double work = 0.0;
  for (int k = 1; k <= 20 * kPeriod; ++k) {
    const std::size_t before = test::count_allocations();
    const bool is_ok = simulation.tick(hand_at(k, mode)).is_ok();
    if (k > 15 * kPeriod) in_ticks += test::count_allocations() - before;
    EXPECT_TRUE(is_ok);
    if (!is_ok) break;
    work += simulation.hand_state().hand_force.norm();
  }
  EXPECT_GT(work, 1.0);
  return in_ticks;
}

struct Case {
  const char* name;
  void (*change)(Params&);
  device::ToolMode mode = device::ToolMode::push;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class Tick : public testing::TestWithParam<Case> {};

TEST_P(Tick, TakesNothingFromTheHeapAfterItsWarmUp) {
  Params params = make_params();
  params.chatter_limit = 0.999;  // the watch looks, but bears a hand that goes round so fast
  GetParam().change(params);
  EXPECT_EQ(count_in_ticks(params, GetParam().mode), 0U);
}

void use_pressure(Params& p) {
  p.contact.law = contact::ContactLaw::pressure;
  p.contact.round_tool = contact::RoundTool{kToolRadius, 0.0, kToolRadius, false};
  p.contact.friction = 0.0;
  p.contact.grip_strength = 1e9;
}

const Case kCases[] = {
    {"push", [](Params&) {}},
    {"two_threads", [](Params& p) { p.threads = 2; }},
    {"pull",
     [](Params& p) {
       p.contact = {20.0, 20.0};
     },
     device::ToolMode::pull},
    {"wet", [](Params&) {}, device::ToolMode::wet},
    {"dry", [](Params&) {}, device::ToolMode::dry},
    {"pressure", use_pressure},
    {"pressure_and_friction",
     [](Params& p) {
       use_pressure(p);
       p.contact.friction = 0.3;
     }},
    {"pressure_pull", use_pressure, device::ToolMode::pull},
    {"pressure_wet", use_pressure, device::ToolMode::wet},
    {"hold", [](Params& p) { p.rates.physics_period_ticks = 10; }},
    {"re_evaluate",
     [](Params& p) {
       p.rates.physics_period_ticks = 10;
       p.rates.between_frames = BetweenFrames::re_evaluate;
     }},
    {"compliant",
     [](Params& p) {
       p.rates.physics_period_ticks = 10;
       p.rates.between_frames = BetweenFrames::compliant;
     }},
    {"p2", [](Params& p) { p.solid.element = solid::ElementKind::p2; }},
    {"p2_hencky_fidelity_local",
     [](Params& p) {
       p.solid.element = solid::ElementKind::p2;
       p.solid.model = solid::StrainModel::hencky;
       p.plasticity.max = 0.0;
       p.fidelity.mode = FidelityMode::automatic;
       p.extent = Extent::local;
     }},
    {"linear", [](Params& p) { p.solid.model = solid::StrainModel::linear; }},
    {"neo_hookean", [](Params& p) { p.solid.model = solid::StrainModel::neo_hookean; }},
    {"hencky",
     [](Params& p) {
       p.solid.model = solid::StrainModel::hencky;
       p.plasticity.max = 0.0;
     }},
    {"p1_nodal", [](Params& p) { p.solid.element = solid::ElementKind::p1_nodal; }},
    {"p1_nodal_bdf2",
     [](Params& p) {
       p.elastic = {1e5, 0.45};
       p.solid.element = solid::ElementKind::p1_nodal;
       p.solid.integrator = solid::Integrator::bdf2;
     }},
    {"p1_nodal_fidelity",
     [](Params& p) {
       p.elastic = {1e5, 0.45};
       p.solid.element = solid::ElementKind::p1_nodal;
       p.fidelity.mode = FidelityMode::automatic;
     }},
    {"p1_nodal_newton",
     [](Params& p) {
       p.elastic = {1e5, 0.45};
       p.solid.element = solid::ElementKind::p1_nodal;
       p.solid.iteration = solid::Iteration::newton;
     }},
    {"bdf2", [](Params& p) { p.solid.integrator = solid::Integrator::bdf2; }},
    {"explicit",
     [](Params& p) {
       p.solid.integrator = solid::Integrator::symplectic_euler;
       p.solid.rayleigh_stiffness = 0.0;
       p.rates.haptic_period = 1e-4;
     }},
    {"newton", [](Params& p) { p.solid.iteration = solid::Iteration::newton; }},
    {"local", [](Params& p) { p.extent = Extent::local; }},
    {"pcg_jacobi", [](Params& p) { p.solid.solver.kind = linear::SolverKind::pcg_jacobi; }},
    {"without_friction", [](Params& p) { p.contact.friction = 0.0; }},
    {"force_error", [](Params& p) { p.estimates_error = true; }},
    {"force_error_of_a_pressure",
     [](Params& p) {
       use_pressure(p);
       p.estimates_error = true;
     }},
    {"force_error_p2",
     [](Params& p) {
       p.solid.element = solid::ElementKind::p2;
       p.estimates_error = true;
     }},
    {"fidelity", [](Params& p) { p.fidelity.mode = FidelityMode::automatic; }},
    {"fidelity_two_threads",
     [](Params& p) {
       p.fidelity.mode = FidelityMode::automatic;
       p.threads = 2;
     }},
    {"fidelity_wet", [](Params& p) { p.fidelity.mode = FidelityMode::automatic; }, device::ToolMode::wet},
    {"fidelity_local",
     [](Params& p) {
       p.fidelity.mode = FidelityMode::automatic;
       p.extent = Extent::local;
     }},
};

INSTANTIATE_TEST_SUITE_P(Heap, Tick, testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

/// A region goes with the tool over a block of 2888 free nodes, to places that no list knows yet. A deeper
/// press before has had more contacts than there will be.
TEST(TickOfARegion, TakesNothingFromTheHeapWhereItHasNotBeen) {
  constexpr int kWarm = 300;  // ticks
  for (const int threads : {1, 2}) {
    Params params = make_params();
    params.fidelity.mode = FidelityMode::automatic;
    params.contact.friction = 0.0;
    params.chatter_limit = 0.999;
    params.kernel.radius = 0.008;
    params.extent = Extent::automatic;
    params.threads = threads;
    const auto hand = [](int tick) {
      const double depth = tick < 100 ? 2e-5 * tick : std::max(3e-4, 2e-3 - 2e-5 * (tick - 100));
      device::DeviceSample sample;  // at one end of the block, then along it
      sample.position = {0.0153 + 2e-5 * std::max(0, tick - 200), 0.0222, 0.02 + kToolRadius - depth};
      sample.mode = device::ToolMode::push;
      return sample;
    };
    device::DeviceSample away = hand(0);
    away.position.z() += 0.003;
    Simulation simulation(test::make_block_body(37, 18, 4, Vec3(0.09, 0.045, 0.02)),
                          contact::make_sphere_tool(kToolRadius, 2), params, away);
    std::size_t in_ticks = 0;
    int largest = 0;  // nodes of the region
    for (int k = 1; k <= 1200; ++k) {
      const std::size_t before = test::count_allocations();
      ASSERT_TRUE(simulation.tick(hand(k)).is_ok()) << k;
      if (k <= kWarm) continue;
      in_ticks += test::count_allocations() - before;
      largest = std::max(largest, simulation.physics_record().active_nodes);
    }
    EXPECT_EQ(in_ticks, 0U) << threads;
    EXPECT_GT(largest, 40);
    EXPECT_LT(largest, 2000);  // a region, never the whole
  }
}

/// What the first touch takes goes with the contacts, and not with the mesh. The bodies differ in what is far
/// from the tool.
TEST(FirstTouch, TakesTheSameFromTheHeapOnABodyOfNineTimesAsManyTets) {
  const auto count_bytes = [](int cells, FidelityMode mode, Extent extent, double tolerance) {
    Params params = make_params();
    params.solid.solver.tolerance = tolerance;
    params.fidelity.mode = mode;
    params.contact.friction = 0.0;
    params.kernel.radius = 0.008;
    params.extent = extent;
    const auto hand = [](int tick) {
      device::DeviceSample sample;
      sample.position = {0.0153, 0.0153, 0.02 + kToolRadius + 1e-3 - 2e-5 * tick};
      sample.mode = device::ToolMode::push;
      return sample;
    };
    Simulation simulation(test::make_block_body(cells, cells, 4, Vec3(0.0025 * cells, 0.0025 * cells, 0.02)),
                          contact::make_sphere_tool(kToolRadius, 2), params, hand(0));
    const std::size_t before = test::count_bytes();
    for (int k = 1; k <= 100; ++k) EXPECT_TRUE(simulation.tick(hand(k)).is_ok());
    EXPECT_GT(simulation.hand_state().hand_force.norm(), 0.01);
    return static_cast<double>(test::count_bytes() - before);
  };
  for (const auto& [mode, extent, tolerance] : {std::tuple{FidelityMode::full, Extent::local, 1e-3},
                                                std::tuple{FidelityMode::automatic, Extent::local, 1e-3},
                                                std::tuple{FidelityMode::full, Extent::whole, 1e-3},
                                                std::tuple{FidelityMode::full, Extent::whole, 1e-6}}) {
    const double small = count_bytes(12, mode, extent, tolerance);
    const double large = count_bytes(36, mode, extent, tolerance);
    EXPECT_NEAR(large / small, 1.0, 0.1) << small << " and " << large << " bytes";
  }
}

TEST(HeapCount, SeesAnAllocation) {
  const std::size_t bytes = test::count_bytes();
  const std::size_t before = test::count_allocations();
  const std::vector<int> list(1000, 1);
  const Field field = Field::Zero(1000);
  EXPECT_GE(test::count_allocations() - before, 2U);
  EXPECT_GE(test::count_bytes() - bytes, 1000 * (sizeof(int) + sizeof(double)));
  EXPECT_EQ(field.sum() + list[3], 1.0);
}

}  // namespace
}  // namespace argil::sim

#endif
