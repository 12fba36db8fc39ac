#include "run/loop.h"

#include <array>
#include <chrono>
#include <cmath>

#include "run/cost_meter.h"
#include "run/interrupt.h"
#include "run/progress.h"

namespace argil::run {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Adds up wall-clock time per stage of the loop.
class StageClock final : public sim::StageObserver {
 public:
  void begin(sim::Stage) override { m_begin = std::chrono::steady_clock::now(); }
  void end(sim::Stage stage) override {
    m_seconds[static_cast<std::size_t>(stage)] += seconds_since(m_begin);
  }
  std::vector<std::pair<std::string, double>> seconds(double total, Tick ticks) const {
    constexpr std::array<const char*, static_cast<std::size_t>(sim::Stage::count)> kNames = {
        "contact", "water", "assemble", "solve", "kinematics", "plasticity"};
    std::vector<std::pair<std::string, double>> list;
    for (std::size_t i = 0; i < kNames.size(); ++i) list.emplace_back(kNames[i], m_seconds[i]);
    list.emplace_back("total", total);
    list.emplace_back("tick_rate_Hz", total > 0.0 ? static_cast<double>(ticks) / total : 0.0);
    return list;
  }

 private:
  std::chrono::steady_clock::time_point m_begin;
  std::array<double, static_cast<std::size_t>(sim::Stage::count)> m_seconds = {};
};

/// Appends what a tick gave. Returns whether the tool touched the body.
bool append_records(sim::Simulation& simulation, FullModel* full, output::ResultFile& file) {
  const sim::HapticRecord haptic = simulation.haptic_record();
  file.append(haptic);
  if (full) full->compare(simulation);
  if (simulation.physics_due_last_tick()) {
    sim::PhysicsRecord record = simulation.physics_record();
    if (full) record.fidelity.error = full->take_error();
    file.append(record);
  }
  if (simulation.frame_due_last_tick()) file.append(simulation.make_frame());
  return haptic.num_contacts > 0;
}

/// The ticks themselves. Returns the failure, if any.
std::optional<Failure> run_ticks(const scenario::Scenario& s, Tick num_ticks, HandMotion& hand,
                                 sim::Simulation& simulation, FullModel* full, output::ResultFile& file,
                                 CostMeter& cost, Progress& progress, bool& has_touched) {
  Tick last_checkpoint = simulation.clock().tick;
  for (Tick k = simulation.clock().tick + 1; k <= num_ticks; ++k) {
    const device::DeviceSample sample = hand.advance(k, simulation.hand().gated().force);
    cost.begin();
    const StepStatus status = simulation.tick(sample);
    cost.end();
    if (!status.is_ok()) return status.failure();
    if (full)
      if (const StepStatus beside = full->tick(sample); !beside.is_ok()) return beside.failure();
    if (append_records(simulation, full, file)) has_touched = true;
    progress.update(k);
    if (!simulation.physics_due_last_tick()) continue;
    const bool is_due = s.checkpoint_period_ticks > 0 && k - last_checkpoint >= s.checkpoint_period_ticks;
    if ((is_due || is_interrupted()) && k < num_ticks) {
      Snapshot snapshot = simulation.take_snapshot();
      Archive archive = Archive::make_saving(snapshot);
      hand.serialize(archive);
      if (full) full->save(snapshot);
      file.write_checkpoint(snapshot);
      last_checkpoint = k;
      if (is_interrupted()) break;
    }
  }
  if (const StepStatus status = simulation.hand().status(); !status.is_ok()) return status.failure();
  return {};
}

}  // namespace

std::optional<device::ToolMode> find_fixed_mode(const scenario::Scenario& s) {
  switch (s.tool.mode) {
    case scenario::ModeChoice::push:
      return device::ToolMode::push;
    case scenario::ModeChoice::pull:
      return device::ToolMode::pull;
    case scenario::ModeChoice::wet:
      return device::ToolMode::wet;
    case scenario::ModeChoice::dry:
      return device::ToolMode::dry;
    case scenario::ModeChoice::trace:
      break;
  }
  return std::nullopt;
}

device::DeviceSample sample_at(const scenario::Scenario& s, const device::Trace& trace, Tick ticks) {
  device::DeviceSample sample =
      device::interpolate(trace, s.trace.start + static_cast<double>(ticks) * s.params.rates.haptic_period);
  sample.mode = find_fixed_mode(s).value_or(sample.mode);
  return sample;
}

Tick count_ticks(const scenario::Scenario& s, double duration) {
  constexpr double kRounding = 1e-6;
  return static_cast<Tick>(std::floor(duration / s.params.rates.haptic_period + kRounding));
}

Tick count_ticks(const scenario::Scenario& s, const device::Trace& trace) {
  return count_ticks(s, s.trace.duration > 0.0 ? s.trace.duration : trace.duration() - s.trace.start);
}

std::uint64_t count_frames(const scenario::Scenario& s, Tick tick) {
  return 1 + static_cast<std::uint64_t>(tick / s.params.rates.frame_period_ticks);  // one at the start
}

LoopEnd run_loop(const scenario::Scenario& s, Tick num_ticks, HandMotion& hand, sim::Simulation& simulation,
                 FullModel* full, output::ResultFile& file, bool shows_progress) {
  watch_signals();
  Progress progress(num_ticks, shows_progress);
  StageClock clock;
  simulation.observe_stages(&clock);
  const auto start = std::chrono::steady_clock::now();
  const Tick first = simulation.clock().tick;
  if (first == 0) file.append(simulation.make_frame());
  LoopEnd end;
  CostMeter cost;
  end.failure = run_ticks(s, num_ticks, hand, simulation, full, file, cost, progress, end.has_touched);
  const Tick last = simulation.clock().tick;
  end.is_interrupted = !end.failure && last < num_ticks;
  if (!simulation.frame_due_last_tick()) file.append(simulation.make_frame());  // the last good state
  end.seconds = seconds_since(start);
  auto timing = clock.seconds(end.seconds, last - first);
  timing.emplace_back("cpu", cost.cpu_seconds());
  if (const auto instructions = cost.instructions()) timing.emplace_back("instructions", *instructions);
  file.append_timing(timing);
  simulation.observe_stages(nullptr);
  return end;
}

}  // namespace argil::run
