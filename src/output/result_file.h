#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "base/status.h"
#include "device/gate.h"
#include "device/haptic_device.h"
#include "mesh/tet_mesh.h"
#include "output/frame_writer.h"
#include "sim/record.h"
#include "sim/state.h"

namespace argil::output {

/// What does not change during a run.
struct ResultHeader {
  Points rest_position;  ///< 3×n [m]
  Tets tets;
  Triangles surface_triangles;                    ///< boundary of the tets, outward
  Triangles skin_triangles;                       ///< 3×0 without a skin
  mesh::TriangleMesh tool;                        ///< tool surface in its own frame
  std::vector<sim::TouchedPlace> touched_places;  ///< by which cells were graded
  double haptic_period = 0.0;                     ///< [s]
  sim::FidelityMode fidelity = sim::FidelityMode::full;
  bool estimates_error = false;  ///< of the force at the hand
  FramePrecision frame_precision = FramePrecision::whole;
  std::vector<std::pair<std::string, std::string>>
      provenance;  ///< name → text: resolved scenario, contact's stiffness, hashes, numerics tag
};

/// Where a live session began.
struct SessionHead {
  std::string device;          ///< as it calls itself
  device::DeviceSample start;  ///< before the first tick
  double max_force = 0.0;      ///< [N] that scenario and device allow
  double max_torque = 0.0;     ///< [N m] likewise; 0: no limit
};

/// What a tick of a live session took from outside, besides the motion that /haptic has.
struct SessionTick {
  std::int64_t sample = 0;  ///< number of the device's sample
  Tick seen_step = 0;       ///< last physics step whose surface the tick met
  Tick begun_step = 0;      ///< step that took its input at the tick's end; 0: none
  device::DeviceState device_state = device::DeviceState::ready;
  device::HandFeed feed = device::HandFeed::fresh;  ///< what the gate took the force to rest on
};

/// A recorded live session: with scenario and build all that its bits are a function of.
struct Session {
  SessionHead head;
  std::vector<SessionTick> ticks;
  std::vector<device::DeviceSample> samples;      ///< that each of them consumed, world coordinates
  std::vector<sim::TouchedPlace> touched_places;  ///< by which cells were graded
  std::string end_hash;                           ///< of the state at its end; empty when it was killed
  bool is_interrupted = false;                    ///< it was stopped, or killed
};

/// Wall clock of a tick of a live session.
struct TickTiming {
  double wake_late = 0.0;   ///< [s]
  double work = 0.0;        ///< [s] from waking to the force that was sent
  double sample_age = 0.0;  ///< [s]
  int missed = 0;           ///< periods without a tick before it
};

/// And of a physics step.
struct StepTiming {
  double wait = 0.0;  ///< [s] from the hand's giving to the step's begin
  double work = 0.0;  ///< [s]
  int late = 0;       ///< ticks beyond the planned ones that it had to wait for
};

/// How a run ended; the root attribute `outcome` spells it.
enum class Outcome {
  running,      ///< being written, or killed
  done,         ///< reached the scenario's end: the only one with `complete` = 1
  interrupted,  ///< stopped by the user, whole up to the last record
  failed,       ///< stopped by a failure, which is in /failure
};

/// The result of one run in HDF5, appended as it goes: whole chunks, a flush per chunk, so a run killed at
/// any moment keeps all but its last chunk. Written to FILE, with `complete` = 0 until finish(). Throws
/// IoError, also when another process is writing FILE. A destroyed object that was not finished leaves all
/// its records and `complete` = 0.
class ResultFile {
 public:
  ResultFile(const std::string& file, const ResultHeader& header);
  /// Goes on with an unfinished file: keeps what was recorded up to and including `last_tick` and the first
  /// `num_frames` frames, removes the rest; further frames are written to `precision`. Throws IoError when
  /// FILE is not a result file or lost records up to that tick.
  ResultFile(const std::string& file, Tick last_tick, std::uint64_t num_frames, FramePrecision precision);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void append(const sim::HapticRecord& record);
  void append(const sim::PhysicsRecord& record);
  void append(const sim::Frame& frame);
  /// The body has got new cells, of which the frames that follow are.
  void begin_epoch(const sim::Body& body);
  /// From here on a session: a SessionTick before each haptic record. `is_timed`: with a TickTiming each, and
  /// a StepTiming before each physics record.
  void begin_session(const SessionHead& head, bool is_timed);
  void append(const SessionTick& tick);
  void append(const TickTiming& timing);
  void append(const StepTiming& timing);
  /// SHA-256 of the state in which it ended.
  void end_session(const std::string& hash);
  /// Wall-clock seconds per stage, total and rate; goes to /timing, the only part that may differ between
  /// equal runs. A name that ends in _Hz has that unit, any other is in seconds.
  void append_timing(const std::vector<std::pair<std::string, double>>& stages);
  /// Replaces the checkpoint by one of the state after the last record, and writes all records up to it: both
  /// or neither are found after a kill. finish() of a run that reached its end removes it.
  void write_checkpoint(const Snapshot& state);
  /// Writes what is buffered, the failure if there was one, the outcome, and closes. No appends after it.
  void finish(const std::optional<Failure>& failure, bool interrupted = false);

 private:
  void append_fidelity(const sim::PhysicsRecord& record);

  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Adds to a complete result what error of the force at the hand was wanted and is estimated [of the force],
/// and to its /timing what the ticks of the passes before it took of all processors [s].
void write_accuracy(const std::string& result_file, double wanted, double estimated, double cpu_of_passes);

/// Writes the XDMF beside a result file so that ParaView opens it: cage with saturation and plastic strain,
/// skin with saturation and region of influence, one time step a frame. It names the result file relative to
/// itself. Throws IoError.
void write_xdmf(const std::string& result_file, const std::string& xdmf_file);
/// Is it there, and was it written to its end?
bool has_whole_xdmf(const std::string& xdmf_file);

}  // namespace argil::output
