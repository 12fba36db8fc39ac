#pragma once

// Between the readers of one file format and the checks that all traces share.

#include <string>
#include <vector>

#include "device/trace.h"

namespace argil::device::internal {

/// A trace as its file spells it: device coordinates, nothing checked but the format itself.
struct RawTrace {
  DeviceToWorld device_to_world;  ///< from the header
  double metres_per_unit = 1.0;   ///< of the position columns
  bool is_length_given = false;   ///< the file or the options say that unit
  bool is_time_given = false;     ///< and that of the times
  bool is_in_world =
      false;             ///< places are the tool's in a result: no unit, transform or turn is left to apply
  double rate_hz = 0.0;  ///< from the header; 0: not stated
  std::string device;
  std::vector<double> time;  ///< [s]; empty without a time column
  std::vector<Vec3> position;
  std::vector<Vec4> orientation;  ///< x, y, z, w; empty without orientation columns
  std::vector<ToolMode> mode;     ///< empty without a mode column
  std::vector<std::string> ignored_columns;
  std::vector<std::string> notes;  ///< what was not as the plain format has it, a line each
  std::vector<std::size_t>
      line;               ///< line in the file of each sample; empty: samples are rows 0, 1, … of arrays
  bool are_rows = false;  ///< `line` counts rows of an array from 1
};

/// Throws InputError for bytes that are no text, with what they are (packed, UTF-16 without a byte order
/// mark) and how to make text of them.
void require_text(const std::string& file, const std::string& bytes);

RawTrace parse_csv(const std::string& file, const std::string& text, const TraceOptions& options,
                   bool are_rows = false);
/// A table of NumPy's (.npy) whose columns the options name.
RawTrace parse_npy(const std::string& file, const std::string& bytes, const TraceOptions& options);
RawTrace read_hdf5(const std::string& file, const TraceOptions& options);

}  // namespace argil::device::internal
