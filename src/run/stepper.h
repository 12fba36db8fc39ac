#pragma once

#include <optional>
#include <string>

#include "output/result_file.h"
#include "run/loop.h"
#include "run/ready_run.h"

namespace argil::run {

/// How a program steps a run.
struct StepperOptions {
  std::string record;       ///< result file; empty: none is written
  std::string given_trace;  ///< as of ReadyRun
  std::optional<device::DeviceSample>
      start;  ///< where the hand is; nothing: where the scenario's motion begins
};

/// A run whose ticks a program makes, one at a time: along the scenario's motion, which gives the bits of
/// `argil run`, or with a hand of the program's own. The first tick decides which.
class Stepper {
 public:
  /// Throws InputError, also for a scenario without ticks, and for one without a motion where `start` is
  /// none.
  Stepper(const scenario::Scenario& s, const StepperOptions& options);

  /// The next tick of the scenario's motion. A failed one leaves all as it was before. Throws InputError past
  /// the motion's end, and where the hand is the program's own; IoError.
  StepStatus tick();
  /// The hand is at `sample` when the tick ends. Throws InputError where that is no pose, or no mode that the
  /// scenario leaves open; IoError.
  StepStatus tick(const device::DeviceSample& sample);

  /// Ends the record, if there is one: as `argil run` does after the motion's last tick, else as one that was
  /// interrupted. With a hand of the program's own all ticks are made, unless `is_interrupted`. No tick after
  /// it.
  void finish(bool is_interrupted = false);

  const scenario::Scenario& scenario() const { return m_run.s; }
  const scenario::Scene& scene() const { return m_run.scene; }
  sim::Simulation& simulation() { return m_run.simulation; }
  /// Where the hand is, and what the tool does.
  const device::DeviceSample& hand() const { return m_hand; }
  Tick num_ticks() const { return m_num_ticks; }  ///< of the scenario's motion

 private:
  enum class Mover { none, motion, program };

  StepStatus make(Mover mover, const device::DeviceSample& sample);
  void begin_record(Mover mover);
  void check_sample(const device::DeviceSample& sample) const;
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const;

  StepperOptions m_options;
  ReadyRun m_run;
  Remesher m_remesher;  // of ticks without a record
  Tick m_num_ticks;
  device::DeviceSample m_hand;
  Mover m_mover = Mover::none;
  bool m_is_finished = false;
  std::optional<Failure> m_failure;  // of the last tick
  std::optional<output::ResultFile> m_file;
  std::optional<RecordedTicks> m_ticks;
};

}  // namespace argil::run
