#include "run/loop.h"

#include <array>
#include <chrono>
#include <cmath>

#include "run/cost_meter.h"
#include "run/interrupt.h"
#include "run/progress.h"

namespace argil::run {
namespace {

const char* const kNoCellsUntil = "cells/none_until";  // in a checkpoint

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

struct RecordedTicks::Cost {
  StageClock stages;
  CostMeter meter;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

RecordedTicks::RecordedTicks(const scenario::Scenario& s, sim::Simulation& simulation, FullModel* full,
                             output::ResultFile& file, bool is_quiet)
    : m_simulation(simulation),
      m_full(full),
      m_file(file),
      m_remesher(s, &file, is_quiet),
      m_first(simulation.clock().tick),
      m_cost(std::make_unique<Cost>()) {
  m_simulation.observe_stages(&m_cost->stages);
  if (m_first == 0) m_file.append(m_simulation.make_frame());
}

RecordedTicks::~RecordedTicks() {
  m_simulation.observe_stages(nullptr);
}

StepStatus RecordedTicks::make(const device::DeviceSample& sample) {
  m_cost->meter.begin();
  const StepStatus status = m_simulation.tick(sample);
  m_cost->meter.end();
  ARGIL_TRY(status);
  if (m_full) ARGIL_TRY(m_full->tick(sample));
  const sim::HapticRecord haptic = m_simulation.haptic_record();
  m_has_touched |= haptic.num_contacts > 0;
  m_is_limited |= (haptic.gate_events & device::kGateWatchdog) != 0;
  m_file.append(haptic);
  if (m_full) m_full->compare(m_simulation);
  if (m_simulation.physics_due_last_tick()) {
    sim::PhysicsRecord record = m_simulation.physics_record();
    if (m_full) record.fidelity.error = m_full->take_error();
    m_is_limited |= record.limited_tets > 0;
    m_file.append(record);
  }
  if (m_simulation.frame_due_last_tick()) m_file.append(m_simulation.make_frame());
  m_cost->meter.begin();
  m_remesher.renew_if_spoilt(m_simulation);
  m_cost->meter.end();
  return StepStatus::ok();
}

double RecordedTicks::end() {
  const Tick last = m_simulation.clock().tick;
  if (!m_simulation.frame_due_last_tick()) m_file.append(m_simulation.make_frame());
  const double seconds = seconds_since(m_cost->start);
  auto timing = m_cost->stages.seconds(seconds, last - m_first);
  timing.emplace_back("cpu", m_cost->meter.cpu_seconds());
  if (m_remesher.seconds() > 0.0) timing.emplace_back("new_cells", m_remesher.seconds());
  if (const auto instructions = m_cost->meter.instructions())
    timing.emplace_back("instructions", *instructions);
  m_file.append_timing(timing);
  return seconds;
}

Tick find_no_cells_until(const Snapshot& checkpoint) {
  const auto found = checkpoint.find(kNoCellsUntil);
  return found == checkpoint.end() ? -1 : static_cast<Tick>(found->second(0, 0));
}

LoopEnd run_loop(const scenario::Scenario& s, Tick num_ticks, HandMotion& hand, sim::Simulation& simulation,
                 FullModel* full, output::ResultFile& file, bool shows_progress, Tick no_cells_until) {
  Progress progress(num_ticks, shows_progress);
  RecordedTicks ticks(s, simulation, full, file, !shows_progress);
  ticks.remesher().wait_until(no_cells_until);
  StepStatus status = StepStatus::ok();
  Tick last_checkpoint = simulation.clock().tick;
  for (Tick k = simulation.clock().tick + 1; k <= num_ticks; ++k) {
    status = ticks.make(hand.advance(k, simulation.hand().gated().force));
    if (!status.is_ok()) break;
    progress.update(k);
    if (!simulation.physics_due_last_tick()) continue;
    const bool is_due = s.checkpoint_period_ticks > 0 && k - last_checkpoint >= s.checkpoint_period_ticks;
    if ((is_due || is_interrupted()) && k < num_ticks) {
      Snapshot snapshot = simulation.take_snapshot();
      Archive archive = Archive::make_saving(snapshot);
      hand.serialize(archive);
      snapshot[kNoCellsUntil] =
          Eigen::MatrixXd::Constant(1, 1, static_cast<double>(ticks.remesher().waits_until()));
      if (full) full->save(snapshot);
      file.write_checkpoint(snapshot);
      last_checkpoint = k;
      if (is_interrupted()) break;
    }
  }
  if (status.is_ok()) status = simulation.hand().status();
  LoopEnd end;
  if (!status.is_ok()) end.failure = status.failure();
  end.is_interrupted = !end.failure && simulation.clock().tick < num_ticks;
  end.has_touched = ticks.has_touched();
  end.is_limited = ticks.is_limited();
  end.seconds = ticks.end();
  return end;
}

}  // namespace argil::run
