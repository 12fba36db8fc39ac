#include "device/trace_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"

namespace argil::device::internal {
namespace {

constexpr double kMaxGapIntervals = 10.0;  // no pause of fewer median intervals is too long
constexpr double kPauseIntervals = 3.0;    // a pause of more median intervals is said
constexpr double kRounding = 1e-9;         // of differences of times
constexpr int kMostPausesSaid = 5;
constexpr double kMaxRateError =
    0.05;  // stated rate against the median interval; clocks jitter, units do not

// A motion out of all reason. Few samples may be written by hand, far apart.
constexpr std::size_t kManySamples = 50;
constexpr double kLongestInterval = 0.2;    // [s] of many samples
constexpr double kShortestInterval = 1e-5;  // [s]
constexpr std::size_t kSomeSamples = 10;
constexpr double kFastestHand = 20.0;     // [m/s] in a hundredth of a motion
constexpr double kFastestMean = 3.0;      // [m/s]
constexpr double kWidestMotion = 5.0;     // [m]
constexpr double kFarPlace = 5.0;         // [m] from the origin: a room's, of motion capture
constexpr double kFarthestInRoom = 10.0;  // [m] from the origin: of no such room
constexpr double kLongInterval = 1.0;     // [s] of samples of a slow motion
constexpr double kSlowestHand = 1e-3;     // [m/s] in the mean
constexpr double kWideMotion = 1.0;       // [m] less may be fast: a stab that someone wrote

// A motion in steps.
constexpr double kLongestHold = 0.5;    // [s] a longer one is a rest
constexpr double kRepeatedShare = 0.4;  // of the samples of a motion
constexpr std::size_t kSomeMoves = 10;
constexpr double kFeltStep = 1e-4;  // [m] of the median jump; usual devices resolve 1e-5 to 6e-5

template <class T>
T take_quantile(std::vector<T> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  const auto place = values.begin() + std::min(at, static_cast<std::ptrdiff_t>(values.size()) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double median_interval(const std::vector<double>& time) {
  std::vector<double> interval;
  for (std::size_t i = 1; i < time.size(); ++i) interval.push_back(time[i] - time[i - 1]);
  return take_quantile(std::move(interval), 0.5);
}

void check_order(const std::string& file, const RawTrace& raw) {
  const std::vector<double>& t = raw.time;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (!std::isfinite(t[i]))
      throw InputError(file, print_place(raw, i), "time is " + print_number(t[i]),
                       "give a finite number of seconds");
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1]))
      throw InputError(
          file, print_place(raw, i),
          "time " + print_number(t[i]) + " s does not come after " + print_number(t[i - 1]) + " s",
          "sort the samples and leave each time once");
}

/// In which unit would the median interval be a device's?
const char* guess_time_unit(double median) {
  return median < 100.0 ? "ms" : median < 1e5 ? "us" : "ns";
}

void check_rate(const std::string& file, const RawTrace& raw, double median) {
  if (raw.is_time_given) return;
  const bool is_slow = raw.time.size() >= kManySamples && median > kLongestInterval;
  if (!is_slow && !(median < kShortestInterval)) return;
  throw UnlikelyUnit(file, "",
                     std::to_string(raw.time.size()) + " samples at a median interval of " +
                         print_number(median) + " s are no recorded motion if times are in s",
                     "/trace/time_unit", "s, ms, us or ns", is_slow ? guess_time_unit(median) : "");
}

double longest_gap(const std::vector<double>& time) {
  double longest = 0.0;
  for (std::size_t i = 1; i < time.size(); ++i) longest = std::max(longest, time[i] - time[i - 1]);
  return longest;
}

void bridge_pauses(const std::string& file, const TraceOptions& options, double median, RawTrace& raw) {
  const std::vector<double>& t = raw.time;
  int count = 0;
  std::size_t longest = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double gap = t[i] - t[i - 1];
    if (!(gap > kPauseIntervals * median)) continue;
    if (!(gap <= std::max((1.0 + kRounding) * options.max_gap, kMaxGapIntervals * median)))
      throw InputError(
          file, print_place(raw, i),
          "pause of " + print_number(gap) + " s, longer than /trace/max_gap_s, " +
              print_number(options.max_gap) + " s, and than " + print_number(kMaxGapIntervals) +
              " median intervals of " + print_number(median) + " s",
          "cut the trace there, or bridge it by a straight line by /trace/max_gap_s, for instance " +
              print_number(std::ceil(1000.0 * longest_gap(t)) / 1000.0));
    if (longest == 0 || gap > t[longest] - t[longest - 1]) longest = i;
    if (++count <= kMostPausesSaid)
      raw.notes.push_back("pause of " + print_number(gap) + " s at " + print_number(t[i - 1] - t[0]) +
                          " s (" + print_place(raw, i) + "), bridged by a straight line");
  }
  if (count > kMostPausesSaid)
    raw.notes.push_back(std::to_string(count) + " pauses in all are bridged, the longest of " +
                        print_number(t[longest] - t[longest - 1]) + " s (" + print_place(raw, longest) + ")");
}

}  // namespace

std::string print_place(const RawTrace& raw, std::size_t i) {
  if (raw.line.empty()) return "row " + std::to_string(i);
  return raw.are_rows ? "row " + std::to_string(raw.line[i] - 1) : "line " + std::to_string(raw.line[i]);
}

std::string print_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void check_times(const std::string& file, const TraceOptions& options, RawTrace& raw) {
  check_order(file, raw);
  const double median = median_interval(raw.time);
  check_rate(file, raw, median);
  bridge_pauses(file, options, median, raw);
  if (raw.rate_hz > 0.0 && !(std::abs(median * raw.rate_hz - 1.0) <= kMaxRateError))
    throw InputError(
        file, "header",
        "rate_hz " + print_number(raw.rate_hz) + " but the median interval is " + print_number(median) + " s",
        "correct the rate, or the unit of the time column");
}

namespace {

/// With three digits, which are enough of a size that is out of reason.
std::string print_short(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// Far from the device's own origin a motion may be slow and small, and yet in another unit.
void check_farthest(const std::string& file, const RawTrace& raw, Trace& trace) {
  double farthest = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < raw.position.size(); ++i)
    if (const double away = raw.metres_per_unit * raw.position[i].norm(); away > farthest) {
      farthest = away;
      at = i;
    }
  if (farthest <= kFarPlace) return;
  const std::string problem = "place " + print_short(farthest) + " m from the device's origin if it is in m";
  if (farthest > kFarthestInRoom)
    throw UnlikelyUnit(file, print_place(raw, at), problem + ", where no hand's device reaches",
                       "/trace/length_unit", "m, cm, mm or um", "mm");
  trace.notes.push_back(problem + " (" + print_place(raw, at) +
                        "); give another unit by /trace/length_unit: cm, mm or um");
}

double mean_speed(const Trace& trace) {
  double path = 0.0;
  for (std::size_t i = 1; i < trace.samples.size(); ++i)
    path += (trace.samples[i].position - trace.samples[i - 1].position).norm();
  return path / trace.duration();
}

}  // namespace

void note_slow_motion(Trace& trace) {
  const double median = median_interval(trace.time);
  const double mean = mean_speed(trace);
  if (trace.samples.size() < kSomeSamples || !(median >= kLongInterval && mean < kSlowestHand)) return;
  trace.notes.push_back(
      "samples are " + print_short(median) + " s apart (median) and the motion is " +
      print_short(1e3 * mean) +
      " mm/s fast in the mean, slower than a hand; perhaps times are in ms: give the unit by "
      "/trace/time_unit, s or ms");
}

void check_path(const std::string& file, const RawTrace& raw, Trace& trace) {
  if (!trace.is_length_assumed || trace.samples.size() < kSomeSamples) return;
  Vec3 low = trace.samples[0].position;
  Vec3 high = low;
  std::vector<double> speed;
  for (std::size_t i = 1; i < trace.samples.size(); ++i) {
    const Vec3& place = trace.samples[i].position;
    const double way = (place - trace.samples[i - 1].position).norm();
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
    speed.push_back(way / (trace.time[i] - trace.time[i - 1]));
  }
  const double mean = mean_speed(trace);
  const double fast = take_quantile(std::move(speed), 0.99);
  const double width = (high - low).norm();
  const bool is_fast = mean > kFastestMean || fast > kFastestHand;
  if (width <= kWidestMotion && !(is_fast && width > kWideMotion)) return check_farthest(file, raw, trace);
  throw UnlikelyUnit(file, "",
                     "the motion is " + print_number(width) + " m wide, " + print_number(mean) +
                         " m/s fast in the mean and " + print_number(fast) +
                         " m/s at its fastest, which is no hand's if places are in m",
                     "/trace/length_unit", "m, cm, mm or um", "mm");
}

void note_steps(const RawTrace& raw, double metres, std::vector<std::string>& notes) {
  const auto is_moved = [&](std::size_t i) { return raw.position[i] != raw.position[i - 1]; };
  std::vector<std::size_t> held;  // samples from move to move
  std::vector<double> change;     // of each coordinate that changed [m]
  std::vector<double> jumps;      // [m]
  std::size_t last = 0;
  for (std::size_t i = 1; i < raw.position.size(); ++i) {
    if (!is_moved(i)) continue;
    if (last > 0 && raw.time[i] - raw.time[last] <= kLongestHold) {
      held.push_back(i - last);
      const Vec3 step = metres * (raw.position[i] - raw.position[i - 1]);
      if (!step.allFinite()) return;  // refused elsewhere
      jumps.push_back(step.norm());
      for (const double along : step)
        if (along != 0.0) change.push_back(std::abs(along));
    }
    last = i;
  }
  if (held.size() < kSomeMoves) return;
  std::size_t samples = 0;
  for (const std::size_t count : held) samples += count;
  const auto moves = static_cast<double>(held.size());
  const double repeated = 1.0 - moves / static_cast<double>(samples);
  const double jump = take_quantile(jumps, 0.5);
  if (!(repeated >= kRepeatedShare && jump >= kFeltStep)) return;
  const double step = *std::min_element(change.begin(), change.end());
  const auto is_whole = [step](double size) {
    return std::abs(size / step - std::round(size / step)) <= 0.01;
  };
  const bool is_grid =
      std::all_of(change.begin(), change.end(), is_whole) && take_quantile(change, 0.5) < 3.5 * step;
  char text[512];
  char what[128];
  if (is_grid)
    std::snprintf(what, sizeof what, "places are in steps of %.3g mm", 1e3 * step);
  else
    std::snprintf(what, sizeof what, "places are held for %zu samples (median)", take_quantile(held, 0.5));
  std::snprintf(text, sizeof text,
                "%s: while it moves, %.0f %% of the samples repeat the last place, then it jumps by %.2g mm, "
                "and so does the force; "
                "set /hand/kind to simulated, whose spring smooths the motion, or give a finer recording",
                what, 100.0 * repeated, 1e3 * jump);
  notes.push_back(text);
}

}  // namespace argil::device::internal
