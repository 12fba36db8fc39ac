#include "run/stepper.h"

#include <cmath>

#include "base/error.h"
#include "base/print.h"
#include "run/files.h"
#include "run/replay.h"
#include "run/run.h"
#include "run/start.h"

namespace argil::run {
namespace {

const scenario::Scenario& require_ticks(const scenario::Scenario& s, bool has_start) {
  if (s.mode == scenario::Mode::equilibrium)
    throw InputError(s.file, "/dynamics/mode", "\"static\" has no ticks to step",
                     "run it to a file, or set it to \"dynamic\"");
  if (!has_start) require_motion(s, "add it, or give the position at which a hand of your own starts");
  return s;
}

/// As one that is written: three printed digits.
bool is_unit(const Quat& q) {
  constexpr double kMaxUnitError = 1e-3;
  return std::abs(q.coeffs().stableNorm() - 1.0) <= kMaxUnitError;
}

}  // namespace

Stepper::Stepper(const scenario::Scenario& s, const StepperOptions& options)
    : m_options(options),
      m_run(require_ticks(s, options.start.has_value()), options.given_trace, "", options.start),
      m_remesher(m_run.s, nullptr, true),
      m_num_ticks(m_run.scene.trace.samples.empty() ? 0 : count_ticks(m_run.s, m_run.scene.trace)),
      m_hand(options.start ? *options.start : sample_at(m_run.s, m_run.scene.trace, 0)) {
  if (!m_options.record.empty()) check_result_name(m_run.s, m_options.record, "the record");
}

void Stepper::refuse(const std::string& problem, const std::string& remedy) const {
  throw InputError(m_run.s.file, "tick " + std::to_string(m_run.simulation.clock().tick + 1), problem,
                   remedy);
}

void Stepper::check_sample(const device::DeviceSample& sample) const {
  if (!sample.position.allFinite())
    refuse("the hand's position " + print_place(sample.position) + " is not finite",
           "give three numbers [m]");
  if (!is_unit(sample.orientation))
    refuse("the hand's orientation is no unit quaternion", "give x, y, z, w of norm 1");
  const auto fixed = find_fixed_mode(m_run.s);
  if (fixed && sample.mode != *fixed)
    refuse("the hand's mode is \"" + std::string(to_string(sample.mode)) + "\", but /tool/mode is \"" +
               std::string(to_string(*fixed)) + "\"",
           "set /tool/mode to \"trace\"");
}

StepStatus Stepper::tick() {
  if (m_mover == Mover::program)
    refuse("the hand has been a program's own so far, and a run has one hand", "give its position");
  require_motion(m_run.s, "give the hand's position");
  const Tick k = m_run.simulation.clock().tick + 1;
  if (k > m_num_ticks)
    refuse("the scenario's motion has " + std::to_string(m_num_ticks) + " ticks", "stop before it");
  return make(Mover::motion, m_run.hand.advance(k, m_run.simulation.hand().gated().force));
}

StepStatus Stepper::tick(const device::DeviceSample& sample) {
  if (m_mover == Mover::motion)
    refuse("the hand has followed the scenario's motion so far, and a run has one hand",
           "leave it without a position");
  check_sample(sample);
  device::DeviceSample unit = sample;
  unit.orientation = device::make_unit(sample.orientation);
  return make(Mover::program, unit);
}

StepStatus Stepper::make(Mover mover, const device::DeviceSample& sample) {
  if (m_is_finished) refuse("comes after the record's end", "step a new run");
  if (!m_ticks && !m_options.record.empty()) begin_record(mover);
  m_mover = mover;
  const StepStatus status = m_ticks ? m_ticks->make(sample) : m_run.simulation.tick(sample);
  if (!m_ticks && status.is_ok()) m_remesher.renew_if_spoilt(m_run.simulation);
  m_failure.reset();
  if (status.is_ok()) {
    m_hand = sample;
  } else {
    m_failure = status.failure();
    if (m_ticks) finish();
  }
  return status;
}

/// A hand of the program's own has left the scenario's motion, as a device does: the record does not name it.
void Stepper::begin_record(Mover mover) {
  if (mover == Mover::program) {
    const scenario::Scenario bare = without_trace(m_run.s);
    scenario::Scene& scene = m_run.scene;
    scene.trace.sha256.clear();
    scene.contact_cells.clear();
    if (!m_run.miss.empty()) scene.notes.pop_back();  // it is the last, and of the motion
    scene.notes.emplace_back("the hand was a program's own");
    output::ResultHeader header = make_header(bare, m_run.simulation, scene, m_run.tool, find_identity(bare));
    header.fidelity = m_run.s.params.fidelity.mode;
    m_file.emplace(m_options.record, header);
  } else {
    m_file.emplace(m_options.record, m_run.make_header(find_identity(m_run.s)));
  }
  m_ticks.emplace(m_run.s, m_run.simulation, m_run.full.get(), *m_file, true);
}

void Stepper::finish(bool is_interrupted) {
  if (m_is_finished) return;
  if (m_options.record.empty()) {
    m_is_finished = true;
    return;
  }
  if (!m_ticks) begin_record(Mover::motion);
  m_is_finished = true;
  const bool lacks_ticks = m_mover != Mover::program && m_run.simulation.clock().tick < m_num_ticks;
  m_ticks->end();
  m_ticks.reset();
  m_file->finish(m_failure, !m_failure && (is_interrupted || lacks_ticks));
  output::write_xdmf(m_options.record, name_xdmf(m_options.record));
}

}  // namespace argil::run
