// Times of a recording: numbers in a unit, seconds and nanoseconds in two columns, dates and times of day.

#include <cmath>

#include "base/error.h"
#include "device/csv.h"
#include "device/trace_parser.h"

namespace argil::device::internal {
namespace {

/// With the date before it where that has a column of its own.
std::string calendar_text(const Parser& parser) {
  return (parser.layout.has(kDate) ? parser.cell(kDate) + " " : "") + parser.cell(kTime);
}

/// A column of dates is read where the times are times of day.
void choose_date(Parser& parser) {
  Layout& layout = parser.layout;
  if (!layout.has(kDate) || (is_time_of_day(parser.cell(kTime)) && is_date(parser.cell(kDate)))) return;
  layout.ignored.insert(layout.ignored.begin(), layout.date_name);
  layout.column[kDate] = Layout::kAbsent;
}

/// Adds a day where a time of day steps back by nearly one.
void pass_midnight(Parser& parser, std::size_t line, Moment& moment) {
  constexpr std::int64_t kDay = 86400;             // [s]
  constexpr std::int64_t kNearlyADay = 23 * 3600;  // [s]
  if (!is_time_of_day(parser.cell(kTime))) return;
  if (!parser.raw.line.empty() && moment.whole < parser.clock.whole - kNearlyADay) {
    if (parser.num_midnights++ == 0) parser.midnight_line = line;
  }
  parser.clock = moment;
  moment.whole += kDay * parser.num_midnights;
}

Moment read_calendar(Parser& parser, std::size_t line) {
  const int column = parser.layout.column[kTime];
  const std::string text = calendar_text(parser);
  auto moment = find_calendar_time(text);
  if (!moment)
    throw InputError(parser.file, parser.place(line, column),
                     quote(text) + " is not a calendar time as the first is",
                     "write all as 2024-01-31 12:00:00.125");
  pass_midnight(parser, line, *moment);
  return *moment;
}

/// A number of units, with the nanoseconds of a second column.
Moment read_number(Parser& parser, std::size_t line) {
  const int column = parser.layout.column[kTime];
  const std::string& text = parser.cell(kTime);
  if (!is_number(text))
    throw InputError(parser.file, parser.place(line, column), quote(text) + " is not a number",
                     "write a time like 0.125, or a date and time like 2024-01-31 12:00:00.125");
  read_cell(parser, line, kTime);
  auto moment = find_moment(text);
  if (!moment)
    throw InputError(parser.file, parser.place(line, column), "time " + quote(text) + " is out of range",
                     "give a time of fewer digits");
  if (parser.layout.has(kNanoseconds)) moment->fraction += read_cell(parser, line, kNanoseconds) / 1e9;
  return *moment;
}

}  // namespace

void choose_time_unit(Parser& parser, std::size_t line) {
  if (!parser.layout.has(kTime)) return;
  choose_date(parser);
  RawTrace& raw = parser.raw;
  const int column = parser.layout.column[kTime];
  const std::string& stated = parser.layout.unit[kTime];
  const bool has_key = parser.options.time_unit != TimeUnit::automatic;
  const bool is_calendar = find_calendar_time(calendar_text(parser)).has_value();
  const bool is_pair = parser.layout.has(kNanoseconds);
  if ((is_calendar || is_pair) && has_key)
    throw InputError(
        parser.file, parser.place(line, column),
        (is_pair ? "time is in seconds and nanoseconds" : quote(parser.cell(kTime)) + " is a calendar time") +
            ", but /trace/time_unit is " + std::string(to_word(parser.options.time_unit)),
        "leave that key out");
  if (is_calendar) {
    parser.is_calendar = true;
    raw.is_time_given = true;
    raw.notes.push_back("times are calendar times, counted from the first, " + calendar_text(parser));
  } else if (is_pair) {
    raw.is_time_given = true;
  } else if (has_key) {
    parser.per_second = per_second(parser.options.time_unit);
    raw.is_time_given = true;
    if (find_time_unit(stated) != parser.per_second) note_key(parser, "/trace/time_unit", stated);
  } else if (!stated.empty()) {
    const auto unit = find_time_unit(stated);
    if (!unit)
      throw InputError(parser.file, parser.place(line, column), "unit of time " + quote(stated),
                       "give s, ms, us or ns by /trace/time_unit");
    parser.per_second = *unit;
    raw.is_time_given = true;
  }
}

double read_time(Parser& parser, std::size_t line) {
  constexpr double kFarOrigin = 1e6;  // of whose fractions a double begins to lose nanoseconds
  const Moment moment = parser.is_calendar ? read_calendar(parser, line) : read_number(parser, line);
  if (parser.raw.line.empty()) {
    const bool is_far = std::abs(static_cast<double>(moment.whole)) >= kFarOrigin;
    if (parser.is_calendar || is_far) parser.origin = moment;
    if (!parser.is_calendar && is_far)
      parser.raw.notes.push_back(
          "times count from " + parser.cell(kTime) +
          (parser.layout.has(kNanoseconds) ? " s and " + parser.cell(kNanoseconds) + " ns" : std::string()));
  }
  if (!parser.is_calendar && parser.origin.whole == 0 && !parser.layout.has(kNanoseconds))
    return read_cell(parser, line, kTime) / parser.per_second;
  return (static_cast<double>(moment.whole - parser.origin.whole) +
          (moment.fraction - parser.origin.fraction)) /
         parser.per_second;
}

void note_times(Parser& parser) {
  if (parser.num_midnights == 0) return;
  parser.raw.notes.push_back(
      "times of day pass midnight " +
      (parser.num_midnights == 1 ? "" : std::to_string(parser.num_midnights) + " times, first ") + "in " +
      parser.place(parser.midnight_line) + ": a day is added");
}

void join_split_date(std::vector<std::string>& fields, int time_column, std::size_t width) {
  if (time_column < 0 || fields.size() != width + 1) return;
  const auto at = static_cast<std::size_t>(time_column);
  if (at + 1 >= fields.size() || !is_date(fields[at]) || !is_time_of_day(fields[at + 1])) return;
  fields[at] += " " + fields[at + 1];
  fields.erase(fields.begin() + time_column + 1);
}

}  // namespace argil::device::internal
