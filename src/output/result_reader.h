#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hdf5/file.h"
#include "output/result_file.h"

namespace argil::output {

/// What identifies a frame without its arrays.
struct FrameInfo {
  std::string name;  ///< in /frames, "000123"
  Tick tick = 0;
  double time = 0.0;       ///< [s]
  std::string state_hash;  ///< SHA-256, of what sim::Frame says
  int epoch = 0;           ///< how often the body had got new cells
};

/// Cells of an epoch: those at the start, or those that the body got while the run went on.
struct CellMesh {
  Points rest_position;  ///< 3×n [m]
  Tets tets;
  Triangles surface_triangles;
};

/// A result file opened for reading, complete or not. Throws IoError when it cannot be read, InputError when
/// it is no result file of this version.
class ResultReader {
 public:
  explicit ResultReader(const std::string& file);
  const std::string& file() const { return m_file.name(); }
  const hdf5::Group& root() const { return m_root; }

  Outcome outcome() const;
  std::optional<Failure> read_failure() const;
  ResultHeader read_header() const;
  int num_epochs() const;  ///< how often the body got new cells
  CellMesh read_cells(int epoch) const;
  /// A body of the last new cells that it got up to a tick, with what ResultFile::begin_epoch writes of it:
  /// for its supports, the vertices that they hold. Nothing where there are none.
  std::optional<sim::Body> find_last_cells(Tick until) const;
  /// Text of /provenance by its name; nothing when it is not there.
  std::optional<std::string> find_provenance(const std::string& name) const;
  /// `error` of a record is 0 where the run has not estimated it.
  std::vector<sim::HapticRecord> read_haptic() const;
  bool has_force_error() const;
  std::vector<sim::PhysicsRecord> read_physics() const;
  /// What each physics step left out; none in a run that computed all of it. `error` is 0 but in `check`.
  std::optional<std::vector<sim::FidelityRecord>> find_fidelity() const;
  std::vector<FrameInfo> read_frame_list() const;  ///< in the order of ticks
  sim::Frame read_frame(const FrameInfo& info) const;
  /// State from which an unfinished run can go on; nothing when there is none.
  std::optional<Snapshot> find_checkpoint() const;
  /// Of a run to /fidelity/accuracy that is complete: the wanted error of the force and the estimated one.
  std::optional<std::array<double, 2>> find_accuracy() const;
  /// The live session that this is, as far as its ticks are in the file; nothing for other runs.
  std::optional<Session> find_session() const;
  /// Last value of every entry of /timing, by name.
  std::vector<std::pair<std::string, double>> read_timing() const;

 private:
  hdf5::File m_file;
  hdf5::Group m_root;
};

}  // namespace argil::output
