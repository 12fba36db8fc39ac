#include "device/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"
#include "base/text_encoding.h"
#include "device/trace_checks.h"

namespace argil::device {

using internal::print_number;
using internal::print_place;
using internal::RawTrace;

namespace {

constexpr double kMaxUnitError =
    1e-3;  // three printed digits of a quaternion; beyond, it is another quantity
constexpr double kSnapFraction = 1e-6;  // of an interval: a query this near a sample is that sample
constexpr double kSmallArc = 1e-6;      // [rad]; below, chord and arc weights differ by less than its square

void fill_times(const std::string& file, const TraceOptions& options, RawTrace& raw) {
  if (raw.position.size() < 2)
    throw InputError(file, "", std::to_string(raw.position.size()) + " samples", "a trace needs two or more");
  if (!raw.time.empty()) return;
  const double rate = raw.rate_hz > 0.0 ? raw.rate_hz : options.default_rate_hz;
  if (!(rate > 0.0 && std::isfinite(rate)))
    throw InputError(
        file, "", "no time column and no sampling rate",
        "name a column t [s] or give the rate in Hz by /trace/default_rate_hz, for instance 1000");
  for (std::size_t i = 0; i < raw.position.size(); ++i) raw.time.push_back(static_cast<double>(i) / rate);
  raw.is_time_given = true;
}

Quat checked_orientation(const std::string& file, const RawTrace& raw, std::size_t i) {
  const Vec4& q = raw.orientation[i];
  const double norm = q.stableNorm();
  if (!std::isfinite(norm))
    throw InputError(file, print_place(raw, i), "quaternion is not finite", "give four finite numbers");
  if (norm == 0.0)
    throw InputError(file, print_place(raw, i), "quaternion is zero", "no rotation is x y z w = 0 0 0 1");
  if (!(std::abs(norm - 1.0) <= kMaxUnitError))
    throw InputError(
        file, print_place(raw, i),
        "quaternion has norm " + print_number(norm) + ", not 1 within " + print_number(kMaxUnitError),
        "check the order of the columns, or normalise");
  return make_unit(Quat(q[3], q[0], q[1], q[2]));
}

bool is_identity(const DeviceToWorld& map) {
  return map.scale == 1.0 && map.translation == Vec3::Zero() &&
         map.rotation.coeffs() == Quat::Identity().coeffs() &&
         map.tool_rotation.coeffs() == Quat::Identity().coeffs();
}

}  // namespace

// The identity is skipped: multiplying by it would turn −0 into 0, and a replay must give the recorded bits.
void move_to_world(const DeviceToWorld& map, DeviceSample& sample) {
  if (is_identity(map)) return;
  sample.position = map.rotation * (map.scale * sample.position) + map.translation;
  sample.orientation = map.rotation * sample.orientation;
  if (map.tool_rotation.coeffs() != Quat::Identity().coeffs())
    sample.orientation = sample.orientation * map.tool_rotation;
  sample.orientation = make_unit(sample.orientation);
}

namespace {

[[noreturn]] void refuse_far_place(const std::string& file, const RawTrace& raw, std::size_t i,
                                   const Vec3& at) {
  const std::string problem = "place " + print_number(at.stableNorm()) + " m from the origin, more than " +
                              print_number(kFarthestPlace) + " m";
  if (raw.is_length_given)
    throw InputError(file, print_place(raw, i), problem,
                     "correct the unit of length, or subtract one place from all of them");
  throw UnlikelyUnit(file, print_place(raw, i), problem, "/trace/length_unit", "m, cm, mm or um", "mm");
}

}  // namespace

UnlikelyUnit::UnlikelyUnit(const std::string& file, const std::string& place, const std::string& reason,
                           const std::string& key, const std::string& words, const std::string& likely)
    : InputError(file, place, reason,
                 "give the unit by " + key + ": " + words + (likely.empty() ? "" : ", perhaps " + likely)),
      m_reason(reason),
      m_key(key),
      m_likely(likely) {}

namespace {

RawTrace read_text(const std::string& file, const std::string& text, const TraceOptions& options) {
  internal::require_text(file, text);
  return internal::parse_csv(file, text, options);
}

}  // namespace

Trace read_trace(const std::string& file, const TraceOptions& options) {
  const std::string bytes = read_file(file);
  const bool is_hdf5 = bytes.starts_with("\x89HDF\r\n\x1a\n");
  const bool is_npy = bytes.starts_with("\x93NUMPY");
  RawTrace raw = is_hdf5  ? internal::read_hdf5(file, options)
                 : is_npy ? internal::parse_npy(file, bytes, options)
                          : read_text(file, to_utf8(bytes), options);
  const bool has_times = !raw.time.empty();
  fill_times(file, options, raw);
  internal::check_times(file, options, raw);
  const DeviceToWorld to_world = raw.is_in_world ? DeviceToWorld{} : options.device_to_world;
  const double scale = raw.device_to_world.scale * to_world.scale;
  internal::note_steps(raw, raw.metres_per_unit * scale, raw.notes);
  Trace trace;
  trace.file = file;
  trace.device = raw.device;
  trace.sha256 = Sha256().add(bytes).hex_digest();
  trace.ignored_columns = raw.ignored_columns;
  trace.notes = raw.notes;
  trace.is_in_world = raw.is_in_world;
  if (raw.is_in_world &&
      (!is_identity(options.device_to_world) || options.length_unit != LengthUnit::automatic))
    trace.notes.emplace_back(
        "it is a result, whose places are the tool's in the world: /trace/length_unit and "
        "/trace/device_to_world are not applied to them again");
  trace.time = raw.time;
  trace.samples.reserve(raw.position.size());
  for (std::size_t i = 0; i < raw.position.size(); ++i) {
    if (!raw.position[i].allFinite())
      throw InputError(file, print_place(raw, i), "position is not finite", "give three finite numbers");
    DeviceSample sample;
    sample.position = raw.position[i];
    if (raw.metres_per_unit != 1.0) sample.position *= raw.metres_per_unit;
    if (!raw.orientation.empty()) sample.orientation = checked_orientation(file, raw, i);
    sample.mode = raw.mode.empty() ? options.default_mode : raw.mode[i];
    move_to_world(raw.device_to_world, sample);
    if (!is_within_reach(sample.position)) refuse_far_place(file, raw, i, sample.position);
    move_to_world(to_world, sample);
    trace.samples.push_back(sample);
  }
  trace.is_length_assumed = !raw.is_length_given && scale == 1.0;
  internal::check_path(file, raw, trace);
  if (has_times && options.time_unit == TimeUnit::automatic) internal::note_slow_motion(trace);
  return trace;
}

Quat make_unit(const Quat& q) {
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  if (std::abs(q.squaredNorm() - 1.0) <= kRounding) return q;
  return Quat(q.coeffs().stableNormalized());
}

// Half the rotation angle is the arc θ between a and b on the unit 3-sphere; tan(θ/2) = ‖a−b‖ / ‖a+b‖ keeps
// its accuracy for θ → 0, where the arc cosine of a·b loses half the digits.
Quat slerp_shorter(const Quat& a, const Quat& b, double s) {
  const Vec4& from = a.coeffs();
  const Vec4 to = from.dot(b.coeffs()) < 0.0 ? Vec4(-b.coeffs()) : Vec4(b.coeffs());
  const double theta = 2.0 * std::atan2((from - to).norm(), (from + to).norm());
  double weight_from = 1.0 - s;
  double weight_to = s;
  if (theta > kSmallArc) {
    weight_from = std::sin((1.0 - s) * theta) / std::sin(theta);
    weight_to = std::sin(s * theta) / std::sin(theta);
  }
  const Vec4 between = weight_from * from + weight_to * to;
  return Quat(Vec4(between / between.norm()));
}

DeviceSample interpolate(const Trace& trace, double time) {
  ARGIL_ASSERT(!trace.time.empty() && trace.time.size() == trace.samples.size(), trace.time.size());
  ARGIL_ASSERT(!std::isnan(time));
  const double t = trace.time.front() + time;
  const auto after = std::upper_bound(trace.time.begin(), trace.time.end(), t);
  if (after == trace.time.begin()) return trace.samples.front();
  if (after == trace.time.end()) return trace.samples.back();
  const auto i = static_cast<std::size_t>(after - trace.time.begin()) - 1;
  const double s = (t - trace.time[i]) / (trace.time[i + 1] - trace.time[i]);
  if (s <= kSnapFraction) return trace.samples[i];
  if (s >= 1.0 - kSnapFraction) return trace.samples[i + 1];
  const DeviceSample& a = trace.samples[i];
  const DeviceSample& b = trace.samples[i + 1];
  DeviceSample sample;
  sample.position = (1.0 - s) * a.position + s * b.position;
  sample.orientation = slerp_shorter(a.orientation, b.orientation, s);
  sample.mode = a.mode;
  return sample;
}

}  // namespace argil::device
