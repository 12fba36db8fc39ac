#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "device/sample.h"

namespace argil::device {

/// No place of a motion may be farther from the origin [m]: no device reaches as far.
inline constexpr double kFarthestPlace = 1e3;

/// Is it no farther away than that? No place that is not finite is.
inline bool is_within_reach(const Vec3& place) {
  return place.allFinite() && place.stableNorm() <= kFarthestPlace;
}

enum class TimeUnit { automatic, s, ms, us, ns };      ///< automatic: as the file says, else s
enum class LengthUnit { automatic, m, cm, mm, um };    ///< automatic: as the file says, else m
enum class AngleUnit { automatic, rad, deg };          ///< automatic: as the file says
enum class QuaternionOrder { by_name, wxyz, xyzw };    ///< of columns that are numbered, as q0 to q3
enum class ButtonMode { none, push, pull, wet, dry };  ///< what the tool does while a button is pressed

/// How angles about x, y and z make a rotation: one after the other about the fixed axes (xyz: x first),
/// about the axes as they turn (XYZ), or as one vector, axis times angle. None: they are not read.
enum class AngleOrder { none, xyz, xzy, yxz, yzx, zxy, zyx, XYZ, XZY, YXZ, YZX, ZXY, ZYX, vector };

/// How a trace file is read when its header does not say.
struct TraceOptions {
  DeviceToWorld device_to_world;           ///< applied after the header's own transform; not to a result
  ToolMode default_mode = ToolMode::push;  ///< when the file has no mode column
  double default_rate_hz = 0.0;  ///< > 0: sampling rate when the file has neither a time column nor a rate
  /// CSV, NPY: names of the columns from the left, in place of the file's header row; "" or "-" leaves a
  /// column out, as do columns past the list. For files without a header row, or whose names do not say what
  /// they hold.
  std::vector<std::string> columns;
  TimeUnit time_unit = TimeUnit::automatic;        ///< given, it stands above what the file says
  LengthUnit length_unit = LengthUnit::automatic;  ///< the same
  double max_gap = 0.1;  ///< [s] longest pause between samples that is bridged by a straight line
  QuaternionOrder quaternion_order = QuaternionOrder::by_name;
  AngleOrder angle_order = AngleOrder::none;
  AngleUnit angle_unit = AngleUnit::automatic;
  std::string button_column;  ///< CSV only: it is read as a button; empty: none is
  ButtonMode button_mode = ButtonMode::none;
};

/// A recorded motion in world coordinates, times increasing.
struct Trace {
  std::vector<double> time;  ///< [s]
  std::vector<DeviceSample> samples;
  std::string file;
  std::string device;                        ///< name from the header, may be empty
  std::string sha256;                        ///< of the file's bytes
  std::vector<std::string> ignored_columns;  ///< columns that were not used (velocity, force, …)
  std::vector<std::string> notes;            ///< for the user: what was done to the file's data
  bool is_in_world = false;  ///< it is a result's: keys that place a recording were applied to it before
  bool is_length_assumed = false;  ///< neither file, options nor a scale say the unit of places
  double duration() const { return time.back() - time.front(); }
};

/// A rate or a path out of all reason whose unit nobody gave.
class UnlikelyUnit : public InputError {
 public:
  /// `likely`: what `key` of a scenario would be; empty where nothing is likely.
  UnlikelyUnit(const std::string& file, const std::string& place, const std::string& reason,
               const std::string& key, const std::string& words, const std::string& likely);
  const std::string& reason() const { return m_reason; }
  const std::string& key() const { return m_key; }
  const std::string& likely() const { return m_likely; }

 private:
  std::string m_reason;
  std::string m_key;
  std::string m_likely;
};

/// Reads a CSV (header row names columns), NPY (options name them) or HDF5 trace; the formats are in this
/// folder's README. Throws InputError (file, line, value, remedy) for long pauses, unsorted times, NaN,
/// places beyond kFarthestPlace before device_to_world of the options, zero quaternions, unknown modes, and
/// UnlikelyUnit; IoError when the file cannot be read.
Trace read_trace(const std::string& file, const TraceOptions& options);

/// The sample at `time` seconds after the trace's first: position linear, orientation slerp along the shorter
/// arc, mode of the last sample at or before. Outside the trace the nearest end is held. A query at a
/// sample's time (within 1e-6 of the interval) gives that sample's bits, so a recording replayed at its own
/// rate is exact. O(log n), no allocation.
DeviceSample interpolate(const Trace& trace, double time);

/// A sample in device coordinates becomes one in world coordinates.
void move_to_world(const DeviceToWorld& map, DeviceSample& sample);

/// q scaled to unit length; unchanged to the bit when its norm is 1 within rounding, so that a recorded unit
/// quaternion is read back as it was. Requires a finite q that is not zero.
Quat make_unit(const Quat& q);

/// Rotation from `a` to `b` at the fraction s in [0, 1] of the shorter arc between them. Both of unit length.
Quat slerp_shorter(const Quat& a, const Quat& b, double s);

}  // namespace argil::device
