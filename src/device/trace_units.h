#pragma once

// Units of a recording's columns, and times that a double does not hold to the nanosecond.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "device/trace.h"

namespace argil::device::internal {

/// How many of the unit are a second: 1000 for "ms". Nothing for a word that is none of s, ms, µs, ns.
std::optional<double> find_time_unit(std::string_view word);
/// Metres in the unit: 0.001 for "mm". Nothing for a word that is none of m, cm, mm, µm.
std::optional<double> find_length_unit(std::string_view word);

double per_second(TimeUnit unit);         ///< of no automatic unit
double metres_per(LengthUnit unit);       ///< of no automatic unit
std::string_view to_word(TimeUnit unit);  ///< "ms", as the key has it

/// A number in two parts, for times such as nanoseconds since 1970, of whose digits a double loses three.
struct Moment {
  std::int64_t whole = 0;
  double fraction = 0.0;  ///< of the sign of `whole`, below 1
};

/// The moment that a number spells, with a decimal point or comma. Nothing past 4e18.
std::optional<Moment> find_moment(std::string_view text);

/// A date (year first) and time of day, or a time of day alone: "2024-01-02T12:00:00.125Z", "2024/01/02
/// 12:00:00", "12:00:00.5+01:00". In s since 1970, or since midnight. Nothing for any other text.
std::optional<Moment> find_calendar_time(std::string_view text);

/// Is it a time of day without a date?
bool is_time_of_day(std::string_view text);
/// Is it a date (year first) without a time of day?
bool is_date(std::string_view text);

/// "mm" of "[mm]" or "(mm)".
std::string_view strip_brackets(std::string_view text);

}  // namespace argil::device::internal
