// A simulation that was saved and restored goes on to the same bits as one that was left alone, at any moment
// of a press, with every kind of state that a tick hands to the next; a snapshot of another scene is refused.
#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "contact/tool_shape.h"
#include "sim/simulation.h"
#include "support/block_body.h"
#include "support/temp_folder.h"

namespace argil::sim {
namespace {

constexpr double kToolRadius = 0.008;
constexpr Tick kTicks = 56;  // several steps of every period that the tests take

Params make_params() {
  Params p;
  p.elastic = {1e5, 0.3};
  p.plasticity.yield = 0.01;
  p.kernel = {};
  p.kernel.radius = 0.02;
  p.contact = {50.0, 50.0};
  p.contact.friction = 0.4;
  p.water.diffusivity = 1e-6;
  p.water.wetting_flux = 20.0;
  p.water.drying_flux = 20.0;
  return p;
}

Body make_body(int cells) {
  return test::make_block_body(cells, cells, 2, Vec3(0.04, 0.04, 0.02), 0.2);
}

/// The hand presses and slides; it wets while it does so, then dries.
device::DeviceSample hand_at(Tick tick) {
  device::DeviceSample sample;
  const auto t = static_cast<double>(tick);
  sample.position = {0.0201 + 2e-5 * t, 0.0197, 0.02 + kToolRadius + 0.0005 - 6e-5 * t};
  sample.orientation = Quat(Eigen::AngleAxisd(0.01 * t, Vec3::UnitZ()));
  sample.mode = tick < 30 ? device::ToolMode::wet : device::ToolMode::dry;
  return sample;
}

Simulation make_simulation(const Params& params, int cells = 4) {
  return {make_body(cells), contact::make_sphere_tool(kToolRadius, 2), params, hand_at(0)};
}

void run(Simulation& simulation, Tick last) {
  for (Tick k = simulation.clock().tick + 1; k <= last; ++k)
    ASSERT_TRUE(simulation.tick(hand_at(k)).is_ok()) << k;
}

void expect_same(const Snapshot& a, const Snapshot& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, value] : a) {
    ASSERT_TRUE(b.contains(name)) << name;
    const Eigen::MatrixXd& other = b.at(name);
    ASSERT_TRUE(value.rows() == other.rows() && value.cols() == other.cols()) << name;
    EXPECT_TRUE((value.array() == other.array()).all()) << name;
  }
}

struct Variant {
  const char* name;
  std::function<void(Params&)> set;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> kVariants = {
      {"as it is", [](Params&) {}},
      {"compliant",
       [](Params& p) {
         p.rates.physics_period_ticks = 7;
         p.rates.water_period_ticks = 14;
         p.rates.between_frames = BetweenFrames::compliant;
         p.solid.solver.kind = linear::SolverKind::cholesky;
       }},
      {"re_evaluate",
       [](Params& p) {
         p.rates.physics_period_ticks = 7;
         p.rates.water_period_ticks = 7;
         p.rates.between_frames = BetweenFrames::re_evaluate;
       }},
      {"bdf2", [](Params& p) { p.solid.integrator = solid::Integrator::bdf2; }},
      {"local",
       [](Params& p) {
         p.extent = Extent::local;
         p.solid.region_tolerance = 0.1;
       }},
      {"newmark", [](Params& p) { p.solid.integrator = solid::Integrator::newmark; }},
      {"pressure",
       [](Params& p) {
         p.contact.law = contact::ContactLaw::pressure;
         p.contact.grip_strength = 1e4;
       }},
  };
  return kVariants;
}

TEST(Snapshot, ResumedAtAnyStepItEndsInTheSameBits) {
  for (const Variant& variant : variants()) {
    SCOPED_TRACE(variant.name);
    Params params = make_params();
    variant.set(params);
    Simulation whole = make_simulation(params);
    run(whole, kTicks);
    const Snapshot end = whole.take_snapshot();
    EXPECT_GT(whole.hand_state().hand_force.norm(), 0.0);  // it was pressed
    for (Tick at = 0; at < kTicks; at += 14) {
      Simulation first = make_simulation(params);
      run(first, at);
      const Snapshot saved = first.take_snapshot();
      Simulation resumed = make_simulation(params);
      resumed.restore(saved, "run.h5");
      expect_same(resumed.take_snapshot(), saved);
      run(resumed, kTicks);
      expect_same(resumed.take_snapshot(), end);
    }
  }
}

/// Presses to `depth` [m] and stands still; the surface stands still, too, until the first step.
void press_and_stand(Simulation& simulation, double depth, Tick last) {
  device::DeviceSample sample;
  for (Tick k = simulation.clock().tick + 1; k <= last; ++k) {
    sample.position = {0.0201, 0.0197, 0.02 + kToolRadius - depth};
    ASSERT_TRUE(simulation.tick(sample).is_ok()) << k;
  }
}

// Contacts of a tool and a surface that stand still are not found again. Those that a simulation has when it
// is restored are of another state, however long its tool had stood still.
TEST(Snapshot, RestoredWhereAToolStoodStillItFindsContactsAnew) {
  Params params = make_params();
  params.fidelity.mode = FidelityMode::automatic;
  params.rates.between_frames = BetweenFrames::re_evaluate;
  params.rates.physics_period_ticks = params.rates.water_period_ticks = 20;
  constexpr Tick kAt = 10;
  Simulation deep = make_simulation(params);
  press_and_stand(deep, 0.0006, kAt);
  const Snapshot saved = deep.take_snapshot();
  Simulation fresh = make_simulation(params);
  fresh.restore(saved, "run.h5");
  press_and_stand(fresh, 0.0006, kAt + 3);
  Simulation used = make_simulation(params);
  press_and_stand(used, 0.0002, kAt);
  ASSERT_LT(used.hand_state().hand_force.norm(), 0.9 * deep.hand_state().hand_force.norm());
  used.restore(saved, "run.h5");
  press_and_stand(used, 0.0006, kAt + 3);
  EXPECT_EQ(used.haptic_record().force, fresh.haptic_record().force);
  EXPECT_EQ(used.state_hash(), fresh.state_hash());
}

TEST(Snapshot, OfAnotherSceneIsRefusedByTheFieldsName) {
  const Snapshot saved = make_simulation(make_params()).take_snapshot();
  Simulation larger = make_simulation(make_params(), 5);
  ARGIL_EXPECT_THROW_WITH(larger.restore(saved, "run.h5"), IoError, "run.h5: the checkpoint's contact/x has");
  Snapshot without = saved;
  without.erase("water/saturation");
  Simulation same = make_simulation(make_params());
  ARGIL_EXPECT_THROW_WITH(same.restore(without, "run.h5"), IoError, "the checkpoint has no water/saturation");
}

}  // namespace
}  // namespace argil::sim
