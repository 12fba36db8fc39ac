#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/lower_case.h"
#include "device/csv.h"
#include "device/trace_angles.h"
#include "device/trace_parser.h"
#include "device/trace_units.h"

namespace argil::device::internal {
namespace {

ToolMode read_mode(const Parser& parser, std::size_t line) {
  const int column = parser.layout.column[kMode];
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  if (const auto named = find_tool_mode(text)) return *named;
  const auto number = find_number(text);
  for (int i = 0; number && i < kNumToolModes; ++i)
    if (*number == i) return static_cast<ToolMode>(i);
  throw InputError(parser.file, parser.place(line, column), "mode " + quote(text),
                   "use push, pull, wet, dry or 0, 1, 2, 3");
}

/// The unit that columns' names say, the same for all of `roles`; empty where none says one.
std::string find_stated_unit(const Parser& parser, std::size_t line, const std::array<Role, 3>& roles) {
  const std::string& unit = parser.layout.unit[roles[0]];
  for (const Role role : roles)
    if (parser.layout.unit[role] != unit)
      throw InputError(parser.file, parser.place(line),
                       "columns " + std::string(name_role(roles[0])) + " and " +
                           std::string(name_role(role)) + " are in " + quote(unit) + " and " +
                           quote(parser.layout.unit[role]),
                       "give all in one unit");
  return unit;
}

void choose_length_unit(Parser& parser, std::size_t line) {
  const std::string stated = find_stated_unit(parser, line, {kX, kY, kZ});
  RawTrace& raw = parser.raw;
  raw.is_length_given = true;
  if (parser.options.length_unit != LengthUnit::automatic) {
    raw.metres_per_unit = metres_per(parser.options.length_unit);
    if (find_length_unit(stated) != raw.metres_per_unit) note_key(parser, "/trace/length_unit", stated);
    return;
  }
  const auto unit = find_length_unit(stated);
  if (!stated.empty() && !unit)
    throw InputError(parser.file, parser.place(line), "unit of length " + quote(stated),
                     "give m, cm, mm or um by /trace/length_unit");
  const auto of_header = find_length_unit(parser.header_unit);
  if (unit && of_header && *unit != *of_header)
    throw InputError(
        parser.file, parser.place(line),
        "columns in " + quote(stated) + ", but the header's units are " + quote(parser.header_unit),
        "correct one of them, or give /trace/length_unit");
  raw.metres_per_unit = unit ? *unit : of_header.value_or(1.0);
  raw.is_length_given = unit || of_header;
}

void choose_angle_unit(Parser& parser, std::size_t line) {
  if (!parser.layout.has(kRx)) return;
  const std::string stated = find_stated_unit(parser, line, {kRx, kRy, kRz});
  const auto factor = find_angle_unit(parser.options.angle_unit, stated);
  if (!factor)
    throw InputError(
        parser.file, parser.place(line),
        stated.empty() ? "the unit of the angles is not said" : "unit of angles " + quote(stated),
        "give rad or deg by /trace/angle_unit");
  parser.radians = *factor;
}

bool is_pressed(const Parser& parser, std::size_t line) {
  const int column = parser.layout.button;
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  const std::string word = to_lower_case(text);
  for (const char* known : {"true", "pressed", "down", "on", "yes"})
    if (word == known) return true;
  for (const char* known : {"false", "released", "up", "off", "no"})
    if (word == known) return false;
  const auto number = find_number(text);
  if (number && std::isfinite(*number)) return *number != 0.0;
  throw InputError(parser.file, parser.place(line, column), "button " + quote(text),
                   "use 0 and 1, or true and false");
}

ToolMode find_mode(const Parser& parser, std::size_t line) {
  if (parser.layout.button != Layout::kAbsent && is_pressed(parser, line))
    return static_cast<ToolMode>(static_cast<int>(parser.options.button_mode) - 1);
  return parser.layout.has(kMode) ? read_mode(parser, line) : parser.options.default_mode;
}

Vec4 read_orientation(Parser& parser, std::size_t line) {
  const Role first = parser.layout.has(kRx) ? kRx : kQx;
  Vec4 numbers = Vec4::Zero();
  for (int i = 0; i < (first == kRx ? 3 : 4); ++i)
    numbers[i] = read_cell(parser, line, static_cast<Role>(first + i));
  if (first == kQx) return numbers;
  return turn_by_angles(parser.options.angle_order, parser.radians * numbers.head<3>()).coeffs();
}

/// And another cell behind it, so that the row was not cut in the middle of the last number.
bool holds_all_that_is_read(const Parser& parser) {
  int last = parser.layout.button;
  for (const int column : parser.layout.column) last = std::max(last, column);
  return parser.fields.size() > static_cast<std::size_t>(last) + 1;
}

/// As where several sensors take turns in one table, or a tracker lost its target.
bool holds_no_place(const Parser& parser) {
  constexpr std::array kPlace = {kX, kY, kZ};
  return std::all_of(std::begin(kPlace), std::end(kPlace), [&](Role role) {
    return is_lost(parser.cell(role)) || trim(parser.cell(role)).empty();
  });
}

}  // namespace

// Where points and commas are both there, one may divide thousands.
double read_cell(Parser& parser, std::size_t line, Role role) {
  const int column = parser.layout.column[role];
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  auto number = find_number(text);
  if (number) {
    if (parser.point_line == 0 && text.find('.') != std::string::npos) parser.point_line = line;
  } else {
    number = find_comma_number(text);
    if (number && parser.comma_line == 0) parser.comma_line = line;
  }
  if (!number)
    throw InputError(parser.file, parser.place(line, column), quote(text) + " is not a number",
                     "write it like 0.125");
  if (parser.comma_line != 0 && parser.point_line != 0)
    throw InputError(parser.file, parser.place(line, column),
                     quote(text) + ": decimal commas (line " + std::to_string(parser.comma_line) +
                         ") and points (line " + std::to_string(parser.point_line) + ") in one file",
                     "write all numbers with a point and without a sign between thousands");
  if (!std::isfinite(*number))
    throw InputError(parser.file, parser.place(line, column), quote(text) + " is not finite",
                     "give a finite number");
  return *number;
}

void note_key(Parser& parser, std::string_view key, std::string_view stated) {
  if (!stated.empty())
    parser.raw.notes.push_back(std::string(key) + " is taken, not the unit " + quote(stated) +
                               " of the columns");
}

bool is_number(const std::string& text) {
  return find_number(text) || find_comma_number(text);
}

void read_sample(Parser& parser, std::size_t line) {
  if (parser.fields.size() == parser.width + 1 && parser.fields.back().empty()) parser.fields.pop_back();
  join_split_date(parser.fields, parser.layout.column[kTime], parser.width);
  if (parser.fields.size() < parser.width && holds_all_that_is_read(parser)) {
    if (parser.num_short++ == 0) parser.short_line = line;
    parser.fields.resize(parser.width);
  }
  if (parser.fields.size() != parser.width)
    throw InputError(parser.file, parser.place(line),
                     std::to_string(parser.fields.size()) + " fields, not " + std::to_string(parser.width),
                     std::string("every row has as many fields as the first, by ") +
                         std::string(name_separator(parser.separator)));
  RawTrace& raw = parser.raw;
  const Layout& layout = parser.layout;
  if (holds_no_place(parser)) {
    if (parser.num_placeless++ == 0) parser.placeless_line = line;
    return;
  }
  if (raw.line.empty()) {
    choose_length_unit(parser, line);
    choose_time_unit(parser, line);
    choose_angle_unit(parser, line);
  }
  if (layout.has(kTime)) raw.time.push_back(read_time(parser, line));
  const double x = read_cell(parser, line, kX);
  const double y = read_cell(parser, line, kY);
  raw.position.emplace_back(x, y, read_cell(parser, line, kZ));
  if (layout.has(kQx) || layout.has(kRx)) raw.orientation.push_back(read_orientation(parser, line));
  if (layout.has(kMode) || layout.button != Layout::kAbsent) raw.mode.push_back(find_mode(parser, line));
  raw.line.push_back(line);
}

bool take_units_row(Parser& parser) {
  if (!parser.raw.line.empty() || parser.fields.size() != parser.width) return false;
  const auto cell = [&](Role role) { return strip_brackets(parser.cell(role)); };
  for (const Role role : {kX, kY, kZ})
    if (!find_length_unit(cell(role))) return false;
  if (parser.layout.has(kTime) && !find_time_unit(cell(kTime))) return false;
  for (const Role role : {kTime, kX, kY, kZ, kRx, kRy, kRz})
    if (parser.layout.has(role)) parser.layout.unit[role] = cell(role);
  parser.raw.notes.push_back("units are those of the row under the names: " + std::string(cell(kX)));
  return true;
}

}  // namespace argil::device::internal
