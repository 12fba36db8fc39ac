// What a step costs, stage by stage: the dry demonstration's press on the same dinosaur in tets of three
// sizes.
//   build/bin/bench_step --benchmark_filter=push/tets:10000
// Counters are microseconds per physics step of one haptic tick: `solve` is the median over the steps in
// which the stage ran, `solve_p99` its 99th percentile; `step` is the sum of a step's stages. Push: contact
// and solid, water every tenth step; push_loose: the same solved to 1e-2 instead of 1e-3; push_auto: with
// fidelity auto; push_nodal: at ν = 0.45 with elements that do not lock. Wet: the body feels no force, water
// flows in every step. Compliant: a physics step every 14 ticks, and a surface that yields in between;
// `contact` is that of one tick.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "scenario/build.h"
#include "sim/simulation.h"
#include "stage_clock.h"

namespace argil {
namespace {

// The motion is taken up with the tool off the coarsest body; after the approach, which is not measured, it
// presses the finest too, whose boundary lies closer to the skin.
constexpr double kApproach = 0.45;  // [s] into the motion
constexpr Tick kApproachSteps = 300;
constexpr int kPressSteps = 200;  // the same for every size, so that all press the same part of the motion

enum class Variant { plain, loose, lean, compliant, nodal };

/// The demonstration's scene with a physics step every tick.
struct Press {
  device::Trace trace;
  double start = 0.0;
  device::ToolMode mode;
  std::unique_ptr<sim::Simulation> simulation;

  Press(int tets, int threads, device::ToolMode m, Variant variant) : mode(m) {
    const bool is_compliant = variant == Variant::compliant;
    std::vector<scenario::Setting> settings = {
        // The default, which the demonstration does not take, or ten times that.
        {"/dynamics/solver/tolerance", variant == Variant::loose ? "1e-2" : "1e-3"},
        {"/body/shape/target_tets", std::to_string(tets)},
        {"/haptics/between_frames", is_compliant ? "compliant" : "hold"},
        {"/haptics/physics_period_ticks", is_compliant ? "14" : "1"},
        {"/haptics/frame_period_ticks", is_compliant ? "112" : "100"},
        {"/haptics/water_period_ticks", is_compliant                  ? "14"
                                        : m == device::ToolMode::push ? "10"
                                                                      : "1"}};
    if (variant == Variant::lean) settings.push_back({"/fidelity/mode", "auto"});
    if (variant == Variant::nodal) {
      settings.push_back({"/dynamics/element", "p1_nodal"});
      settings.push_back({"/material/poissons_ratio", "0.45"});
    }
    scenario::Scenario s =
        scenario::load_scenario(ARGIL_SOURCE_DIR "/scenarios/study_soft_dino.json", settings);
    s.params.threads = threads;
    scenario::Scene scene = scenario::build_scene(s);
    trace = std::move(scene.trace);
    start = s.trace.start + kApproach;
    simulation = std::make_unique<sim::Simulation>(std::move(scene.body), scene.tool, s.params, sample(0));
  }
  device::DeviceSample sample(Tick tick) const {
    device::DeviceSample at = device::interpolate(trace, start + 0.001 * static_cast<double>(tick));
    at.mode = mode;
    return at;
  }
  /// One tick; empty, or what went wrong.
  std::string step() {
    const StepStatus status = simulation->tick(sample(simulation->clock().tick + 1));
    return status.is_ok() ? "" : to_string(status.failure());
  }
};

/// A step that counts; scripts/bench_instructions.py collects within it alone.
[[gnu::noinline]] std::string run_measured_step(Press& press) {
  return press.step();
}

void run_steps(benchmark::State& state, device::ToolMode mode, Variant variant = Variant::plain) {
  Press press(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), mode, variant);
  for (Tick tick = 0; tick < kApproachSteps; ++tick)
    if (const std::string fault = press.step(); !fault.empty()) {
      state.SkipWithError(fault.c_str());
      return;
    }
  bench::measure_steps(state, *press.simulation, [&] {
    const std::string fault = run_measured_step(press);
    return fault.empty() && press.simulation->contacts().contacts.empty() ? "the tool does not touch the body"
                                                                          : fault;
  });
}

void push(benchmark::State& state) {
  run_steps(state, device::ToolMode::push);
}

void push_loose(benchmark::State& state) {
  run_steps(state, device::ToolMode::push, Variant::loose);
}

void push_auto(benchmark::State& state) {
  run_steps(state, device::ToolMode::push, Variant::lean);
}

void push_nodal(benchmark::State& state) {
  run_steps(state, device::ToolMode::push, Variant::nodal);
}

void wet(benchmark::State& state) {
  run_steps(state, device::ToolMode::wet);
}

void compliant(benchmark::State& state) {
  run_steps(state, device::ToolMode::push, Variant::compliant);
}

// Meshes are made for about so many tets: these have 2502, 10500 and 42153.
void set_sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"tets", "threads"})->ArgsProduct({{2390, 10000, 42000}, {1, 2}});
  bench->Iterations(kPressSteps)->Unit(benchmark::kMicrosecond)->UseRealTime();
}
BENCHMARK(push)->Apply(set_sizes);
BENCHMARK(push_loose)->Apply(set_sizes);
BENCHMARK(push_auto)->Apply(set_sizes);
BENCHMARK(push_nodal)->Apply(set_sizes);
BENCHMARK(wet)->Apply(set_sizes);
BENCHMARK(compliant)->Apply(set_sizes);

}  // namespace
}  // namespace argil

BENCHMARK_MAIN();
