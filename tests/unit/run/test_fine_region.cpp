// The promise of `fidelity: auto` where it is hardest to keep: many fine tets between the tool and the nodes
// that are left out. Nodes beside those that are held back move less than they would, so that a look at how
// far they have gone takes them for nodes that the hand does not feel.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "scenario/build.h"
#include "sim/simulation.h"

namespace argil {
namespace {

constexpr double kFloor = 0.005, kTolerance = 0.01;  // [N], [–]: of the force
constexpr int kTouches = 60;                         // [ticks]

/// A sphere of clay of 40 k tets, pressed from above at 20 mm/s by a ball of 8 mm: forces and, of the last
/// tick, vertices that were solved for.
std::pair<std::vector<Vec3>, int> press(const std::string& fidelity) {
  const scenario::Scenario s =
      scenario::load_scenario(ARGIL_SOURCE_DIR "/scenarios/study_soft_dino.json",
                              {{"/dynamics/solver/tolerance", "1e-4"},
                               {"/body/shape/kind", "\"sphere\""},
                               {"/body/shape/size_m", "0.1"},
                               {"/body/shape/target_tets", "40000"},
                               {"/body/shape/skin_triangles", "0"},
                               {"/fidelity/mode", '"' + fidelity + '"'},
                               {"/fidelity/force_tolerance", std::to_string(kTolerance)},
                               {"/fidelity/force_floor_N", std::to_string(kFloor)},
                               {"/haptics/physics_period_ticks", "1"},
                               {"/haptics/water_period_ticks", "10"}});
  const auto hand_at = [](Tick tick) {
    device::DeviceSample sample;
    sample.position = Vec3(0.0, 0.0, 0.1085 - 2e-5 * static_cast<double>(tick));
    return sample;
  };
  scenario::Scene scene = scenario::build_scene(s);
  sim::Simulation simulation(std::move(scene.body), scene.tool, s.params, hand_at(0));
  std::vector<Vec3> forces;
  for (int touches = 0; touches < kTouches && forces.size() < 200;) {
    EXPECT_TRUE(simulation.tick(hand_at(simulation.clock().tick + 1)).is_ok());
    forces.push_back(simulation.haptic_record().force);
    touches += forces.back().isZero(0.0) ? 0 : 1;
  }
  return {forces, simulation.physics_record().active_nodes};
}

TEST(FineRegion, LeavesOutOnlyWhatTheHandDoesNotFeel) {
  const auto [full, all] = press("full");
  const auto [with_region, some] = press("auto");
  ASSERT_EQ(full.size(), with_region.size());
  EXPECT_GT(full.back().norm(), 0.3);
  EXPECT_LT(some, all);
  for (std::size_t k = 0; k < full.size(); ++k)
    EXPECT_LE((with_region[k] - full[k]).norm(), std::max(kFloor, kTolerance * full[k].norm())) << k;
}

}  // namespace
}  // namespace argil
