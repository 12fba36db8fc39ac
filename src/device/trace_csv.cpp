#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/hash.h"
#include "device/csv.h"
#include "device/trace_raw.h"

namespace argil::device::internal {
namespace {

enum Role : int { kTime, kX, kY, kZ, kQx, kQy, kQz, kQw, kMode, kNumRoles };
constexpr int kAbsent = -1;
using Layout = std::array<int, kNumRoles>;  // column of each role

const std::map<std::string, Role, std::less<>>& role_names() {
  static const std::map<std::string, Role, std::less<>> kNames = {
      {"t", kTime}, {"time", kTime}, {"t_s", kTime},  {"time_s", kTime}, {"x", kX},
      {"px", kX},   {"x_m", kX},     {"y", kY},       {"py", kY},        {"y_m", kY},
      {"z", kZ},    {"pz", kZ},      {"z_m", kZ},     {"qx", kQx},       {"qy", kQy},
      {"qz", kQz},  {"qw", kQw},     {"mode", kMode}, {"button", kMode}};
  return kNames;
}

const char* const kColumnHelp =
    "the columns are t [s], x y z [m], qx qy qz qw, mode (push, pull, wet, dry or 0 to 3), or name them by "
    "the "
    "trace's list of columns";

struct Parser {
  const std::string& file;
  RawTrace raw;
  std::string body_sha256;  // stated by the header; empty: not stated
  std::vector<std::string> fields;
  Layout layout{};
  std::size_t width = 0;

  std::string place(std::size_t line) const { return "line " + std::to_string(line); }
  std::string place(std::size_t line, int column) const {
    return place(line) + ", column " + std::to_string(column + 1);
  }
};

std::vector<double> header_numbers(const Parser& parser, std::size_t line, std::string_view value,
                                   std::size_t count) {
  std::vector<double> numbers;
  std::size_t at = 0;
  while ((at = value.find_first_not_of(" \t,", at)) != std::string_view::npos) {
    const std::size_t end = std::min(value.find_first_of(" \t,", at), value.size());
    const auto number = find_number(value.substr(at, end - at));
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
    at = end;
  }
  if (numbers.size() != count || at != std::string_view::npos)
    throw InputError(parser.file, parser.place(line),
                     "'" + std::string(value) + "' is not " + std::to_string(count) + " finite numbers",
                     "separate numbers by blanks");
  return numbers;
}

Quat header_rotation(const Parser& parser, std::size_t line, std::string_view value) {
  const std::vector<double> q = header_numbers(parser, line, value, 4);
  const Quat rotation(q[3], q[0], q[1], q[2]);
  constexpr double kMaxUnitError = 1e-3;
  if (!(std::abs(rotation.norm() - 1.0) <= kMaxUnitError))
    throw InputError(parser.file, parser.place(line),
                     "rotation '" + std::string(value) + "' is not of unit length",
                     "give x y z w with norm 1");
  return make_unit(rotation);
}

double length_unit(const Parser& parser, std::size_t line, std::string_view value) {
  if (value == "m") return 1.0;
  if (value == "cm") return 0.01;
  if (value == "mm") return 0.001;
  throw InputError(parser.file, parser.place(line), "unit of length '" + std::string(value) + "'",
                   "use m, cm or mm");
}

void read_header_entry(Parser& parser, std::size_t line, std::string_view key, std::string_view value) {
  RawTrace& raw = parser.raw;
  if (key == "device") {
    raw.device = value;
  } else if (key == "units") {
    raw.metres_per_unit = length_unit(parser, line, value);
  } else if (key == "rate_hz") {
    raw.rate_hz = header_numbers(parser, line, value, 1)[0];
    if (!(raw.rate_hz > 0.0))
      throw InputError(parser.file, parser.place(line), "rate " + std::string(value) + " Hz",
                       "give a positive rate");
  } else if (key == "device_to_world_scale") {
    raw.device_to_world.scale = header_numbers(parser, line, value, 1)[0];
    if (!(raw.device_to_world.scale > 0.0))
      throw InputError(parser.file, parser.place(line), "scale " + std::string(value),
                       "give a positive scale");
  } else if (key == "device_to_world_rotation_xyzw") {
    raw.device_to_world.rotation = header_rotation(parser, line, value);
  } else if (key == "device_to_world_translation_m") {
    const std::vector<double> v = header_numbers(parser, line, value, 3);
    raw.device_to_world.translation = Vec3(v[0], v[1], v[2]);
  } else if (key == "sha256") {
    parser.body_sha256 = value;
  } else {
    throw InputError(parser.file, parser.place(line), "unknown header key '" + std::string(key) + "'",
                     "known: device, units, rate_hz, device_to_world_scale, device_to_world_rotation_xyzw, "
                     "device_to_world_translation_m, sha256");
  }
}

// The header of our own format begins "# argil-trace: 1" and is read strictly; comments of other programs are
// skipped.
void read_header_line(Parser& parser, std::size_t line, std::string_view comment, bool& ours) {
  const std::size_t colon = comment.find(':');
  const std::string_view key = trim(comment.substr(0, std::min(colon, comment.size())));
  const std::string_view value =
      colon == std::string_view::npos ? std::string_view() : trim(comment.substr(colon + 1));
  if (line == 1 && key == "argil-trace") {
    if (value != "1")
      throw InputError(parser.file, parser.place(line), "format version '" + std::string(value) + "'",
                       "this program reads version 1");
    ours = true;
  } else if (ours) {
    if (colon == std::string_view::npos)
      throw InputError(parser.file, parser.place(line), "header line without ':'", "write '# key: value'");
    read_header_entry(parser, line, key, value);
  }
}

void check_body(const Parser& parser, std::string_view body) {
  const std::string& stated = parser.body_sha256;
  if (stated.empty() || stated.find_first_not_of('-') == std::string::npos)
    return;  // "---…": recorder was killed
  const std::string found = Sha256().add(std::as_bytes(std::span(body))).hex_digest();
  if (found != stated)
    throw InputError(parser.file, "header", "sha256 " + stated + " but the body has " + found,
                     "the file was changed after it was recorded; restore it, or remove the sha256 line");
}

void set_layout(Parser& parser, std::size_t line, const std::vector<std::string>& names) {
  parser.layout.fill(kAbsent);
  for (std::size_t column = 0; column < names.size(); ++column) {
    if (names[column].empty() || names[column] == "-") continue;
    const auto known = role_names().find(names[column]);
    if (known == role_names().end()) {
      parser.raw.ignored_columns.push_back(names[column]);
      continue;
    }
    int& slot = parser.layout[static_cast<std::size_t>(known->second)];
    if (slot != kAbsent)
      throw InputError(parser.file, parser.place(line), "two columns for '" + names[column] + "'",
                       kColumnHelp);
    slot = static_cast<int>(column);
  }
  const auto has = [&](Role role) { return parser.layout[role] != kAbsent; };
  if (!has(kX) || !has(kY) || !has(kZ))
    throw InputError(parser.file, parser.place(line), "no columns x, y, z", kColumnHelp);
  const int parts = has(kQx) + has(kQy) + has(kQz) + has(kQw);
  const bool unclear = parts == 0 && std::any_of(names.begin(), names.end(), [](const std::string& name) {
                         return name == "q0" || name == "q1" || name == "quat0" || name == "q_0";
                       });
  if (unclear)
    throw InputError(parser.file, parser.place(line),
                     "the quaternion's columns do not say which is the scalar part",
                     "name them qx qy qz qw by the trace's list of columns");
  if (parts != 0 && parts != 4)
    throw InputError(parser.file, parser.place(line), "some but not all of the columns qx, qy, qz, qw",
                     kColumnHelp);
}

double read_cell(const Parser& parser, std::size_t line, Role role) {
  const int column = parser.layout[role];
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  const auto number = find_number(text);
  if (!number)
    throw InputError(parser.file, parser.place(line, column), "'" + text + "' is not a number",
                     "write it like 0.125");
  if (!std::isfinite(*number))
    throw InputError(parser.file, parser.place(line, column), "'" + text + "' is not finite",
                     "give a finite number");
  return *number;
}

ToolMode read_mode(const Parser& parser, std::size_t line) {
  const int column = parser.layout[kMode];
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  if (const auto named = find_tool_mode(text)) return *named;
  const auto number = find_number(text);
  for (int i = 0; number && i < kNumToolModes; ++i)
    if (*number == i) return static_cast<ToolMode>(i);
  throw InputError(parser.file, parser.place(line, column), "mode '" + text + "'",
                   "use push, pull, wet, dry or 0, 1, 2, 3");
}

void read_sample(Parser& parser, std::size_t line) {
  if (parser.fields.size() != parser.width)
    throw InputError(parser.file, parser.place(line),
                     std::to_string(parser.fields.size()) + " fields, not " + std::to_string(parser.width),
                     "every row has as many fields as the first");
  RawTrace& raw = parser.raw;
  const auto cell = [&](Role role) { return read_cell(parser, line, role); };
  if (parser.layout[kTime] != kAbsent) raw.time.push_back(cell(kTime));
  raw.position.emplace_back(cell(kX), cell(kY), cell(kZ));
  if (parser.layout[kQx] != kAbsent) raw.orientation.emplace_back(cell(kQx), cell(kQy), cell(kQz), cell(kQw));
  if (parser.layout[kMode] != kAbsent) raw.mode.push_back(read_mode(parser, line));
  raw.line.push_back(line);
}

// Is this first row a header row? With columns named by the user, a row whose position is not made of numbers
// is.
bool is_header_row(const Parser& parser, const TraceOptions& options) {
  if (options.columns.empty()) return true;
  for (const Role role : {kX, kY, kZ}) {
    const auto column = static_cast<std::size_t>(parser.layout[role]);
    if (column < parser.fields.size() && find_number(parser.fields[column])) return false;
  }
  return true;
}

// Takes the first row: names of columns, or already a sample when the user named them.
void read_first_row(Parser& parser, std::size_t line, const TraceOptions& options) {
  parser.width = parser.fields.size();
  if (options.columns.size() > parser.width)
    throw InputError(parser.file, parser.place(line),
                     std::to_string(options.columns.size()) + " columns are named but the row has " +
                         std::to_string(parser.width),
                     "name no more than there are");
  set_layout(parser, line, options.columns.empty() ? parser.fields : options.columns);
  if (!is_header_row(parser, options)) read_sample(parser, line);
}

}  // namespace

RawTrace parse_csv(const std::string& file, const std::string& text, const TraceOptions& options) {
  Parser parser{file, {}, {}, {}, {}, 0};
  std::string_view bytes = text;
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // byte order mark
  LineReader lines(bytes);
  std::string_view line;
  bool ours = false;
  bool in_body = false;  // past the comment lines
  while (lines.next(line)) {
    const std::size_t number = lines.line_number();
    if (!in_body && line.starts_with('#')) {
      read_header_line(parser, number, line.substr(1), ours);
      continue;
    }
    if (!in_body) check_body(parser, bytes.substr(lines.line_offset()));
    in_body = true;
    if (trim(line).empty()) continue;
    if (!split_record(line, parser.fields))
      throw InputError(file, parser.place(number), "a quoted field is not closed",
                       "close it, or remove the quotes");
    if (parser.width == 0)
      read_first_row(parser, number, options);
    else
      read_sample(parser, number);
  }
  return std::move(parser.raw);
}

}  // namespace argil::device::internal
