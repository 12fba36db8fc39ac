#pragma once

#include <memory>
#include <optional>

#include "device/trace.h"
#include "output/result_file.h"
#include "run/full_model.h"
#include "run/hand_motion.h"
#include "run/remesher.h"
#include "scenario/scenario.h"
#include "sim/simulation.h"

namespace argil::run {

/// The hand at the end of tick k, with the scenario's mode unless the trace decides.
device::DeviceSample sample_at(const scenario::Scenario& s, const device::Trace& trace, Tick ticks);

/// The scenario's mode; nothing where the trace or the device decides.
std::optional<device::ToolMode> find_fixed_mode(const scenario::Scenario& s);

/// Whole ticks in `duration` [s]; one that is a whole number of ticks up to rounding is that number.
Tick count_ticks(const scenario::Scenario& s, double duration);

/// Whole ticks of the scenario's motion.
Tick count_ticks(const scenario::Scenario& s, const device::Trace& trace);

/// Frames that a run has written when tick `tick` has ended.
std::uint64_t count_frames(const scenario::Scenario& s, Tick tick);

/// Ticks and their record.
class RecordedTicks {
 public:
  /// From the simulation's present tick on; at the first, with the frame before it. `full`, if any, goes
  /// beside. All are kept by reference.
  RecordedTicks(const scenario::Scenario& s, sim::Simulation& simulation, FullModel* full,
                output::ResultFile& file, bool is_quiet);
  ~RecordedTicks();
  RecordedTicks(const RecordedTicks&) = delete;
  RecordedTicks& operator=(const RecordedTicks&) = delete;

  /// One tick, and new cells where they are due; appends the records and the frame that it gives. One that
  /// fails leaves none.
  StepStatus make(const device::DeviceSample& sample);
  /// Has the tool touched the body in one of them?
  bool is_limited() const { return m_is_limited; }  ///< what output::describe_limits tells of
  bool has_touched() const { return m_has_touched; }
  /// Appends the last good state, where no frame shows it, and what the ticks cost. Returns seconds of wall
  /// clock.
  double end();
  Remesher& remesher() { return m_remesher; }

 private:
  struct Cost;
  sim::Simulation& m_simulation;
  FullModel* m_full;
  output::ResultFile& m_file;
  Remesher m_remesher;
  Tick m_first;
  bool m_has_touched = false;
  bool m_is_limited = false;
  std::unique_ptr<Cost> m_cost;
};

/// How the loop ended.
struct LoopEnd {
  std::optional<Failure> failure;
  bool is_interrupted = false;  ///< by SIGINT or SIGTERM
  bool has_touched = false;     ///< the tool, in one of these ticks
  bool is_limited = false;      ///< what output::describe_limits tells of
  double seconds = 0.0;         ///< of wall clock
};

/// Feeds the simulation the hand's motion from its present tick to `num_ticks`, with record and checkpoints.
/// A signal that is watched (interrupt.h) ends it after the next physics step, with a checkpoint there.
/// `full`, if any, goes beside. `no_cells_until`: what a checkpoint that it goes on from has of
/// find_no_cells_until.
LoopEnd run_loop(const scenario::Scenario& s, Tick num_ticks, HandMotion& hand, sim::Simulation& simulation,
                 FullModel* full, output::ResultFile& file, bool shows_progress, Tick no_cells_until = -1);

/// Remesher::waits_until at a checkpoint.
Tick find_no_cells_until(const Snapshot& checkpoint);

}  // namespace argil::run
