#pragma once

#include <fstream>
#include <string>

#include "base/hash.h"
#include "device/trace.h"

namespace argil::device {

/// Writes a motion in world coordinates as a CSV trace, sample by sample, with 17 digits: read_trace gives
/// back the same bits. Throws IoError with the system's reason.
class TraceRecorder {
 public:
  TraceRecorder(const std::string& file, const std::string& device, double rate_hz);
  void append(double time, const DeviceSample& sample);
  /// Fills in the body's hash and closes. A recording that was killed before has "---…" there and stays
  /// readable.
  void finish();

 private:
  void write(const std::string& text);
  [[noreturn]] void fail() const;
  std::string m_file;
  std::ofstream m_stream;
  std::streampos m_hash_position;
  Sha256 m_body;
};

/// Writes a whole trace by a TraceRecorder.
void write_trace_csv(const std::string& file, const Trace& trace, double rate_hz);

}  // namespace argil::device
