// What a step costs from 2000 to a million tets, with the full model and with what the hand needs of it: a
// sphere of 8 mm radius is pressed into each body at 20 mm/s, the same for every size.
//   build/bin/bench_sizes --benchmark_filter=figure/auto/40000
// Steps count from 0.4 mm after the first touch on. Counters are microseconds of a step and of its stages:
// the median over the steps in which the stage ran, with `_p99` the 99th percentile (of 20 steps: the
// longest).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "scenario/build.h"
#include "sim/simulation.h"
#include "stage_clock.h"

namespace argil {
namespace {

constexpr double kToolRadius = 0.008;  // [m]
constexpr double kGap = 0.006;  // [m] from the place to the tool at first; surfaces differ by millimetres
constexpr double kStep = 2e-5;  // [m] of the tool in a tick
constexpr Tick kMostTicksToTouch = 1000;
constexpr int kStepsBefore = 20;  // after the first touch

/// A body and where it is pressed.
struct Target {
  const char* name;
  double size;  // [m]
  Vec3 place;   // [m]
  Vec3 normal;  // outward
};

const std::vector<Target>& targets() {
  static const std::vector<Target> kTargets = {
      {"sphere", 0.1, Vec3(0.0, 0.0, 0.1), Vec3::UnitZ()},
      {"dinosaur", 0.2, Vec3(-0.006, -0.0304, 0.062), -Vec3::UnitY()},  // haunch
      {"figure", 0.2, Vec3(0.0137, 0.0, 0.125), Vec3::UnitX()}};        // belly
  return kTargets;
}

scenario::Scene build(const Target& target, const std::string& fidelity, int tets, int threads,
                      sim::Params& params) {
  scenario::Scenario s = scenario::load_scenario(
      ARGIL_SOURCE_DIR "/scenarios/study_soft_dino.json",
      {{"/dynamics/solver/tolerance", "1e-3"},  // the default, which the scenario does not take
       {"/body/shape/kind", '"' + std::string(target.name) + '"'},
       {"/body/shape/size_m", std::to_string(target.size)},
       {"/body/shape/target_tets", std::to_string(tets)},
       {"/fidelity/mode", '"' + fidelity + '"'},
       {"/haptics/physics_period_ticks", "1"},
       {"/haptics/water_period_ticks", "10"}});
  s.params.threads = threads;
  params = s.params;
  return scenario::build_scene(s);
}

/// The tool on its straight way into the body.
class Press {
 public:
  Press(const Target& target, const std::string& fidelity, int tets, int threads) : m_target(&target) {
    sim::Params params;
    scenario::Scene scene = build(target, fidelity, tets, threads, params);
    m_simulation = std::make_unique<sim::Simulation>(std::move(scene.body), scene.tool, params, sample(0));
  }
  sim::Simulation& simulation() { return *m_simulation; }
  bool touches() const { return !m_simulation->contacts().contacts.empty(); }

  /// One tick; empty, or what went wrong.
  std::string step() {
    const StepStatus status = m_simulation->tick(sample(m_simulation->clock().tick + 1));
    return status.is_ok() ? "" : to_string(status.failure());
  }
  std::string approach() {
    std::string fault;
    while (fault.empty() && !touches()) {
      if (m_simulation->clock().tick == kMostTicksToTouch) return "the tool does not touch the body";
      fault = step();
    }
    for (int i = 0; i < kStepsBefore && fault.empty(); ++i) fault = step();
    return fault;
  }

 private:
  device::DeviceSample sample(Tick tick) const {
    const double distance = kToolRadius + kGap - kStep * static_cast<double>(tick);
    device::DeviceSample at;
    at.position = m_target->place + distance * m_target->normal;
    return at;
  }

  const Target* m_target;
  std::unique_ptr<sim::Simulation> m_simulation;
};

/// The press after its approach, which is made once for all numbers of threads: they give the same bits.
std::string begin(Press& press, const Target& target, const std::string& fidelity, std::int64_t tets) {
  using Key = std::tuple<std::string, std::string, std::int64_t>;
  static std::optional<std::pair<Key, Snapshot>> last;
  const Key key(target.name, fidelity, tets);
  if (last && last->first == key) {
    press.simulation().restore(last->second, "the approach");
    return "";
  }
  if (const std::string fault = press.approach(); !fault.empty()) return fault;
  last.emplace(key, press.simulation().take_snapshot());
  return "";
}

/// Counters of auto beside the full model, if that has run: the largest error of the force at the hand over
/// all steps [N], and over its bound.
void compare_forces(benchmark::State& state, const Target& target, const std::string& fidelity, int tets,
                    const std::vector<Vec3>& forces) {
  static std::map<std::pair<std::string, int>, std::vector<Vec3>> full;
  const std::pair<std::string, int> key(target.name, tets);
  if (fidelity == "full") full[key] = forces;
  const auto at = full.find(key);
  if (fidelity == "full" || at == full.end() || at->second.size() != forces.size()) return;
  const sim::FidelityParams bound;
  double largest = 0.0, over = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double error = (forces[i] - at->second[i]).norm();
    largest = std::max(largest, error);
    over = std::max(over, error / std::max(bound.force_floor, bound.force_tolerance * at->second[i].norm()));
  }
  state.counters["error_N"] = largest;
  state.counters["error_over_bound"] = over;
}

void run_steps(benchmark::State& state, const Target& target, const std::string& fidelity, int tets,
               int threads) {
  Press press(target, fidelity, tets, threads);
  if (const std::string fault = begin(press, target, fidelity, tets); !fault.empty()) {
    state.SkipWithError(fault.c_str());
    return;
  }
  std::vector<Vec3> forces;
  forces.reserve(static_cast<std::size_t>(state.max_iterations));
  bench::measure_steps(state, press.simulation(), [&] {
    std::string fault = press.step();
    forces.push_back(press.simulation().haptic_record().force);
    return fault;
  });
  state.counters["force_N"] = forces.back().norm();
  compare_forces(state, target, fidelity, tets, forces);
}

void register_all() {
  for (const Target& target : targets())
    for (const int tets : {2000, 10000, 40000, 100000, 1000000})
      for (const std::string fidelity : {"full", "auto"})
        for (const int threads : {2, 1}) {
          const std::string name = std::string(target.name) + '/' + fidelity + '/' + std::to_string(tets) +
                                   "/threads:" + std::to_string(threads);
          benchmark::RegisterBenchmark(name.c_str(), run_steps, target, fidelity, tets, threads)
              ->Iterations(tets > 100000 ? 20 : 100)
              ->Unit(benchmark::kMicrosecond)
              ->UseRealTime();
        }
}

}  // namespace
}  // namespace argil

int main(int argc, char** argv) {
  argil::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
