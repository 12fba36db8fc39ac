#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/archive.h"
#include "base/status.h"
#include "mesh/tet_mesh.h"
#include "sim/record.h"

namespace argil::output {

/// What does not change during a run.
struct ResultHeader {
  Points rest_position;  ///< 3×n [m]
  Tets tets;
  Triangles surface_triangles;  ///< boundary of the tets, outward
  Triangles skin_triangles;     ///< 3×0 without a skin
  mesh::TriangleMesh tool;      ///< tool surface in its own frame
  double haptic_period = 0.0;   ///< [s]
  std::vector<std::pair<std::string, std::string>>
      provenance;  ///< name → text: resolved scenario, hashes, numerics tag
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
  /// `num_frames` frames, removes the rest. Throws IoError when FILE is not a result file or lost records up
  /// to that tick.
  ResultFile(const std::string& file, Tick last_tick, std::uint64_t num_frames);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void append(const sim::HapticRecord& record);
  void append(const sim::PhysicsRecord& record);
  void append(const sim::Frame& frame);
  /// Wall-clock seconds per stage, total and rate; goes to /timing, the only part that may differ between
  /// equal runs. A name that ends in _Hz has that unit, any other is in seconds.
  void append_timing(const std::vector<std::pair<std::string, double>>& stages);
  /// Replaces the checkpoint by one of the state after the last record, and writes all records up to it: both
  /// or neither are found after a kill. finish() of a run that reached its end removes it.
  void write_checkpoint(const Snapshot& state);
  /// Writes what is buffered, the failure if there was one, the outcome, and closes. No appends after it.
  void finish(const std::optional<Failure>& failure, bool interrupted = false);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Writes the XDMF beside a result file so that ParaView opens it: cage with saturation and plastic strain,
/// skin with saturation and region of influence, one time step a frame. It names the result file relative to
/// itself. Throws IoError.
void write_xdmf(const std::string& result_file, const std::string& xdmf_file);

}  // namespace argil::output
