#pragma once

#include <string>
#include <vector>

#include "device/sample.h"

namespace argil::device {

/// x_world = rotation · (scale · x_device) + translation; orientations turn with `rotation`.
struct DeviceToWorld {
  double scale = 1.0;
  Quat rotation = Quat::Identity();
  Vec3 translation = Vec3::Zero();  ///< [m]
};

/// How a trace file is read when its header does not say.
struct TraceOptions {
  DeviceToWorld device_to_world;      ///< applied after the header's own transform
  ToolMode default_mode = ToolMode::push;  ///< when the file has no mode column
  double default_rate_hz = 0.0;       ///< > 0: sampling rate when the file has no time column
};

/// A recorded motion in world coordinates, times increasing.
struct Trace {
  std::vector<double> time;  ///< [s]
  std::vector<DeviceSample> samples;
  std::string file;
  std::string device;        ///< name from the header, may be empty
  std::string sha256;        ///< of the file's bytes
  double duration() const { return time.back() - time.front(); }
};

/// Reads a CSV (header row names columns) or HDF5 trace. Throws InputError (file, line, value, remedy) for gaps,
/// unsorted times, NaN, zero quaternions, unknown modes; IoError when the file cannot be read.
Trace read_trace(const std::string& file, const TraceOptions& options);

/// The sample at `time` seconds after the trace's first: position linear, orientation slerp along the shorter
/// arc, mode of the last sample at or before. Outside the trace the nearest end is held.
DeviceSample interpolate(const Trace& trace, double time);

}  // namespace argil::device
