#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "mesh/tet_mesh.h"
#include "sim/record.h"

namespace argil::output {

/// What does not change during a run.
struct ResultHeader {
  Points rest_position;         ///< 3×n [m]
  Tets tets;
  Triangles surface_triangles;  ///< boundary of the tets, outward
  Triangles skin_triangles;     ///< 3×0 without a skin
  mesh::TriangleMesh tool;      ///< tool surface in its own frame
  double haptic_period = 0.0;   ///< [s]
  std::vector<std::pair<std::string, std::string>> provenance;  ///< name → text: resolved scenario, hashes, numerics tag
};

/// The result of one run in HDF5, appended as it goes: whole chunks, a flush per chunk, so a killed run keeps all
/// but its last chunk. Written to FILE, with `complete` = 0 until finish(). Throws IoError.
class ResultFile {
 public:
  ResultFile(const std::string& file, const ResultHeader& header);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void append(const sim::HapticRecord& record);
  void append(const sim::PhysicsRecord& record);
  void append(const sim::Frame& frame);
  /// Wall-clock seconds per stage, total and rate; goes to /timing, the only part that may differ between equal runs.
  void append_timing(const std::vector<std::pair<std::string, double>>& stages);
  /// Writes what is buffered, the failure if there was one, sets `complete` and closes.
  void finish(const std::optional<Failure>& failure);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Writes the XDMF beside a result file so that ParaView opens it: cage with saturation and plastic strain, skin.
void write_xdmf(const std::string& result_file, const std::string& xdmf_file);

}  // namespace argil::output
