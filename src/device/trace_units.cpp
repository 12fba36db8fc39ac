#include "device/trace_units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/lower_case.h"
#include "device/csv.h"

namespace argil::device::internal {
namespace {

/// In small letters, with "u" for the three ways to write µ (UTF-8's micro sign and Greek letter, Latin-1's
/// byte).
std::string plain_word(std::string_view word) {
  std::string plain;
  word = trim(word);
  for (const std::string_view micro : {"\xC2\xB5", "\xCE\xBC", "\xB5"})
    if (word.starts_with(micro)) {
      plain = "u";
      word.remove_prefix(micro.size());
      break;
    }
  return plain + to_lower_case(word);
}

template <std::size_t N>
std::optional<double> find_unit(const std::array<std::pair<std::string_view, double>, N>& units,
                                std::string_view word) {
  const std::string plain = plain_word(word);
  for (const auto& [name, value] : units)
    if (name == plain) return value;
  return std::nullopt;
}

constexpr std::array<std::pair<std::string_view, double>, 16> kTimeUnits = {{{"s", 1.0},
                                                                             {"sec", 1.0},
                                                                             {"secs", 1.0},
                                                                             {"second", 1.0},
                                                                             {"seconds", 1.0},
                                                                             {"ms", 1e3},
                                                                             {"msec", 1e3},
                                                                             {"millisecond", 1e3},
                                                                             {"milliseconds", 1e3},
                                                                             {"us", 1e6},
                                                                             {"usec", 1e6},
                                                                             {"microsecond", 1e6},
                                                                             {"microseconds", 1e6},
                                                                             {"ns", 1e9},
                                                                             {"nsec", 1e9},
                                                                             {"nanoseconds", 1e9}}};

constexpr std::array<std::pair<std::string_view, double>, 8> kLengthUnits = {{{"m", 1.0},
                                                                              {"metres", 1.0},
                                                                              {"meters", 1.0},
                                                                              {"cm", 0.01},
                                                                              {"mm", 0.001},
                                                                              {"millimetres", 0.001},
                                                                              {"millimeters", 0.001},
                                                                              {"um", 1e-6}}};

/// Takes `count` digits; false when there are not as many.
bool take_digits(std::string_view& text, std::size_t count, int& value) {
  if (text.size() < count) return false;
  const auto [end, error] = std::from_chars(text.data(), text.data() + count, value);
  if (error != std::errc() || end != text.data() + count || text[0] == '-') return false;
  text.remove_prefix(count);
  return true;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

bool is_all_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// 0.125 for "125".
double fraction_of(std::string_view digits) {
  return find_number("0." + std::string(digits) + "0").value_or(0.0);
}

/// Days from 1970-01-01 in the calendar of today [Hinnant, days_from_civil].
std::int64_t count_days(int year, int month, int day) {
  const std::int64_t y = year - (month <= 2 ? 1 : 0);
  const std::int64_t era = y / 400;
  const std::int64_t of_era = y - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

/// "2024-01-02" or with slashes or points, and what separates it from the time of day.
bool take_date(std::string_view& text, std::int64_t& days) {
  int year = 0;
  int month = 0;
  int day = 0;
  if (!take_digits(text, 4, year) || text.empty()) return false;
  const std::string_view sign = text.substr(0, 1);
  if (!take(text, "-/.") || !take_digits(text, 2, month) || !take(text, sign) || !take_digits(text, 2, day) ||
      month < 1 || month > 12 || day < 1 || day > 31)
    return false;
  days = count_days(year, month, day);
  return take(text, "T t/_-");
}

/// "+01:00", "-0130", "Z" or nothing [s].
bool take_zone(std::string_view& text, std::int64_t& offset) {
  offset = 0;
  if (text.empty() || take(text, "Zz")) return text.empty();
  const bool is_west = text.front() == '-';
  int hours = 0;
  int minutes = 0;
  if (!take(text, "+-") || !take_digits(text, 2, hours)) return false;
  take(text, ":");
  if (!text.empty() && !take_digits(text, 2, minutes)) return false;
  offset = (is_west ? -1 : 1) * (3600 * hours + 60 * minutes);
  return text.empty();
}

}  // namespace

std::optional<double> find_time_unit(std::string_view word) {
  return find_unit(kTimeUnits, word);
}

std::optional<double> find_length_unit(std::string_view word) {
  return find_unit(kLengthUnits, word);
}

std::string_view to_word(TimeUnit unit) {
  constexpr std::array<std::string_view, 5> kWords = {"auto", "s", "ms", "us", "ns"};
  return kWords[static_cast<std::size_t>(unit)];
}

double per_second(TimeUnit unit) {
  ARGIL_ASSERT(unit != TimeUnit::automatic);
  return *find_time_unit(to_word(unit));
}

double metres_per(LengthUnit unit) {
  ARGIL_ASSERT(unit != LengthUnit::automatic);
  constexpr std::array<std::string_view, 5> kWords = {"auto", "m", "cm", "mm", "um"};
  return *find_length_unit(kWords[static_cast<std::size_t>(unit)]);
}

std::optional<Moment> find_moment(std::string_view text) {
  constexpr std::int64_t kFarthest = 4'000'000'000'000'000'000;  // the difference of two fits 64 bits
  text = trim(text);
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find_first_of(".,"), text.size());
  const std::string_view whole = text.substr(0, point);
  const std::string_view digits = point < text.size() ? text.substr(point + 1) : std::string_view();
  Moment moment;
  if (!whole.empty() && is_all_digits(whole) && is_all_digits(digits)) {
    const auto error = std::from_chars(whole.data(), whole.data() + whole.size(), moment.whole).ec;
    if (error != std::errc() || moment.whole > kFarthest) return std::nullopt;
    moment.fraction = fraction_of(digits);
  } else {  // with an exponent
    const auto number = find_number(text) ? find_number(text) : find_comma_number(text);
    if (!number || !(std::abs(*number) <= static_cast<double>(kFarthest))) return std::nullopt;
    moment.whole = static_cast<std::int64_t>(*number);
    moment.fraction = *number - static_cast<double>(moment.whole);
  }
  if (is_negative) moment = {-moment.whole, -moment.fraction};
  return moment;
}

std::optional<Moment> find_calendar_time(std::string_view text) {
  text = trim(text);
  std::int64_t days = 0;
  const bool has_date = text.size() > 4 && text[2] != ':';
  if (has_date && !take_date(text, days)) return std::nullopt;
  int hour = 0;
  int minute = 0;
  int second = 0;
  if (!take_digits(text, 2, hour) || !take(text, ":") || !take_digits(text, 2, minute) || !take(text, ":") ||
      !take_digits(text, 2, second) || hour > 24 || minute > 59 || second > 60)
    return std::nullopt;
  Moment moment;
  if (take(text, ".,")) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
    moment.fraction = fraction_of(text.substr(0, end));
    text.remove_prefix(end);
  }
  std::int64_t offset = 0;
  if (!take_zone(text, offset)) return std::nullopt;
  moment.whole = 86400 * days + 3600 * hour + 60 * minute + second - offset;
  return moment;
}

bool is_time_of_day(std::string_view text) {
  text = trim(text);
  return text.size() > 2 && text[2] == ':' && find_calendar_time(text);
}

bool is_date(std::string_view text) {
  return trim(text).size() > 4 && find_calendar_time(std::string(trim(text)) + " 00:00:00");
}

std::string_view strip_brackets(std::string_view text) {
  const bool has_brackets = text.size() > 1 && (text.front() == '[' || text.front() == '(');
  return has_brackets ? text.substr(1, text.size() - 2) : text;
}

}  // namespace argil::device::internal
