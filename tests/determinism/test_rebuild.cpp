// Whatever a tick takes from earlier ones is in the archive: a simulation that is made anew from it, at any
// tick of any golden run, has the same hash and goes on to the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/rng.h"
#include "run/hand_motion.h"
#include "run/loop.h"
#include "scenario/build.h"
#include "scenario/setting.h"

namespace argil {
namespace {

const std::string kGolden = ARGIL_SOURCE_DIR "/tests/golden/";

/// Names of the golden runs that have ticks, with their settings.
std::vector<std::pair<std::string, std::vector<std::string>>> list_runs() {
  const auto runs = nlohmann::ordered_json::parse(std::ifstream(kGolden + "runs.json"));
  std::vector<std::pair<std::string, std::vector<std::string>>> list;
  for (const auto& [name, settings] : runs.items())
    if (name != "static") list.emplace_back(name, settings.get<std::vector<std::string>>());
  return list;
}

scenario::Scenario load(const std::vector<std::string>& texts) {
  std::vector<scenario::Setting> settings;
  for (const std::string& text : texts) settings.push_back(scenario::parse_setting(text));
  return scenario::load_scenario(kGolden + "ball.json", settings);
}

/// A run, tick by tick, that can be made anew in between.
class GoldenRun {
 public:
  explicit GoldenRun(const scenario::Scenario& s) : m_scenario(s), m_scene(scenario::build_scene(s)) {
    make();
  }

  Tick num_ticks() const { return run::count_ticks(m_scenario, m_scene.trace); }
  sim::Simulation& simulation() { return *m_simulation; }
  StepStatus tick() {
    const Tick next = m_simulation->clock().tick + 1;
    return m_simulation->tick(m_hand->advance(next, m_simulation->hand().gated().force));
  }
  void rebuild(bool keeps_history = true) {
    Snapshot snapshot = m_simulation->take_snapshot();
    Archive saving = Archive::make_saving(snapshot);
    m_hand->serialize(saving);
    make();
    if (keeps_history)
      m_simulation->restore(snapshot, "archive");
    else
      m_simulation->restore_without_history(snapshot, "archive");
    Archive restoring = Archive::make_restoring(snapshot, "archive");
    m_hand->serialize(restoring);
  }

 private:
  void make() {
    m_simulation.reset();
    m_simulation.emplace(m_scene.body, m_scene.tool, m_scenario.params,
                         run::sample_at(m_scenario, m_scene.trace, 0));
    m_hand.emplace(m_scenario, m_scene.trace);
  }

  const scenario::Scenario& m_scenario;
  scenario::Scene m_scene;
  std::optional<sim::Simulation> m_simulation;
  std::optional<run::HandMotion> m_hand;
};

class Rebuilt : public testing::TestWithParam<std::pair<std::string, std::vector<std::string>>> {};

/// Ticks at which a run is made anew.
std::vector<Tick> draw_ticks(const std::string& name, Tick num_ticks) {
  constexpr int kTimes = 12;
  Rng rng(7, name);
  std::vector<Tick> at;
  for (int i = 0; i < kTimes; ++i)
    at.push_back(static_cast<Tick>(rng.uniform(0.0, static_cast<double>(num_ticks))));
  return at;
}

TEST_P(Rebuilt, GoesOnToTheSameBits) {
  const auto& [name, settings] = GetParam();
  const scenario::Scenario s = load(settings);
  GoldenRun straight(s), rebuilt(s);
  const std::vector<Tick> at = draw_ticks(name, straight.num_ticks());
  for (Tick k = 0; k < straight.num_ticks(); ++k) {
    if (std::find(at.begin(), at.end(), k) != at.end()) {
      rebuilt.rebuild();
      ASSERT_EQ(rebuilt.simulation().state_hash(), straight.simulation().state_hash()) << k;
    }
    ASSERT_TRUE(straight.tick().is_ok() && rebuilt.tick().is_ok()) << k;
    ASSERT_EQ(rebuilt.simulation().haptic_record().force, straight.simulation().haptic_record().force) << k;
  }
  EXPECT_EQ(rebuilt.simulation().state_hash(), straight.simulation().state_hash());
}

TEST_P(Rebuilt, WithoutSolverHistoryGoesOnWithinTheSolversTolerance) {
  const auto& [name, settings] = GetParam();
  const scenario::Scenario s = load(settings);
  GoldenRun straight(s), rebuilt(s);
  const std::vector<Tick> at = draw_ticks(name, straight.num_ticks());
  double largest = 0.0, error = 0.0;
  for (Tick k = 0; k < straight.num_ticks(); ++k) {
    if (std::find(at.begin(), at.end(), k) != at.end()) rebuilt.rebuild(false);
    ASSERT_TRUE(straight.tick().is_ok() && rebuilt.tick().is_ok()) << k;
    const Vec3 force = straight.simulation().haptic_record().force;
    largest = std::max(largest, force.norm());
    error = std::max(error, (rebuilt.simulation().haptic_record().force - force).norm());
  }
  ASSERT_GT(largest, 0.0);
  const sim::Params& params = s.params;
  const bool is_exact =
      linear::is_direct(params.solid.solver.kind) && params.fidelity.mode == sim::FidelityMode::full;
  constexpr double kTolerance = 1e-3;  // the solver's default, and no golden run has a looser one
  constexpr double kOfFlow = 3e-3;     // as documented, where a fast tool meets clay that flows
  const double bound = params.plasticity.strength > 0.0 ? kOfFlow : kTolerance;
  EXPECT_LE(error, is_exact ? 0.0 : bound * largest);
  ASSERT_LE(params.solid.solver.tolerance, kTolerance);
}

INSTANTIATE_TEST_SUITE_P(Golden, Rebuilt, testing::ValuesIn(list_runs()),
                         [](const auto& run) { return run.param.first; });

}  // namespace
}  // namespace argil
