#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "sim/simulation.h"
#include "sim/stage.h"

namespace argil::bench {

inline constexpr auto kNumStages = static_cast<std::size_t>(sim::Stage::count);
inline constexpr std::array<const char*, kNumStages> kStages = {"contact", "water",      "assemble",
                                                                "solve",   "kinematics", "plasticity"};

/// Counters `name` and `name`_p99 of a sample of times; none when it is empty.
inline void report_times(benchmark::State& state, const std::string& name, std::vector<double>& times) {
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  const std::size_t last = times.size() - 1;
  state.counters[name] = times[last / 2];
  state.counters[name + "_p99"] = times[(99 * last) / 100];
}

/// Microseconds of every stage in every step in which it ran, and of whole steps, also what is in no stage.
class StageClock final : public sim::StageObserver {
 public:
  void begin(sim::Stage) override { m_begin = std::chrono::steady_clock::now(); }
  void end(sim::Stage stage) override {
    m_step[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - m_begin).count();
  }
  void begin_step() { m_step_begin = std::chrono::steady_clock::now(); }
  void end_step() {
    for (std::size_t s = 0; s < kNumStages; ++s)
      if (m_step[s] > 0.0) m_samples[s].push_back(m_step[s]);
    m_steps.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - m_step_begin).count());
    m_step = {};
  }
  void report(benchmark::State& state) {
    for (std::size_t s = 0; s < kNumStages; ++s) report_times(state, kStages[s], m_samples[s]);
    report_times(state, "step", m_steps);
  }

 private:
  std::chrono::steady_clock::time_point m_begin, m_step_begin;
  std::array<double, kNumStages> m_step = {};
  std::array<std::vector<double>, kNumStages> m_samples;
  std::vector<double> m_steps;
};

/// Measures `step`, which returns what went wrong, if anything, once an iteration. Counters beside the times:
/// means over the steps.
template <class Step>
void measure_steps(benchmark::State& state, sim::Simulation& simulation, Step step) {
  StageClock clock;
  simulation.observe_stages(&clock);
  double iterations = 0.0;
  double contacts = 0.0;
  for (auto _ : state) {
    clock.begin_step();
    const std::string fault = step();
    clock.end_step();
    if (!fault.empty()) {
      state.SkipWithError(fault.c_str());
      break;
    }
    iterations += simulation.solid().history.counters.linear_iterations;
    contacts += static_cast<double>(simulation.contacts().contacts.size());
  }
  simulation.observe_stages(nullptr);
  clock.report(state);
  const auto steps = static_cast<double>(state.iterations());
  state.counters["steps_per_s"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  state.counters["cg_iterations"] = iterations / steps;
  state.counters["contacts"] = contacts / steps;
  state.counters["tets"] = simulation.body().mesh.num_tets();
}

}  // namespace argil::bench
