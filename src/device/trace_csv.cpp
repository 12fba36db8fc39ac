#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "device/csv.h"
#include "device/trace_columns.h"
#include "device/trace_raw.h"

namespace argil::device::internal {
namespace {

struct Parser {
  const std::string& file;
  const TraceOptions& options;
  RawTrace raw;
  std::string body_sha256;  // stated by the header; empty: not stated
  std::vector<std::string> fields;
  Layout layout;
  std::size_t width = 0;
  char separator = ',';
  std::size_t comma_line = 0;  // first line with a decimal comma; 0: none yet
  std::size_t point_line = 0;  // with a decimal point

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

/// The number of a cell, with a decimal point or a decimal comma, but one of them in the whole file: where
/// both are, one may divide thousands.
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
    throw InputError(parser.file, parser.place(line, column), "'" + text + "' is not a number",
                     "write it like 0.125");
  if (parser.comma_line != 0 && parser.point_line != 0)
    throw InputError(parser.file, parser.place(line, column),
                     "'" + text + "': decimal commas (line " + std::to_string(parser.comma_line) +
                         ") and points (line " + std::to_string(parser.point_line) + ") in one file",
                     "write all numbers with a point and without a sign between thousands");
  if (!std::isfinite(*number))
    throw InputError(parser.file, parser.place(line, column), "'" + text + "' is not finite",
                     "give a finite number");
  return *number;
}

ToolMode read_mode(const Parser& parser, std::size_t line) {
  const int column = parser.layout.column[kMode];
  const std::string& text = parser.fields[static_cast<std::size_t>(column)];
  if (const auto named = find_tool_mode(text)) return *named;
  const auto number = find_number(text);
  for (int i = 0; number && i < kNumToolModes; ++i)
    if (*number == i) return static_cast<ToolMode>(i);
  throw InputError(parser.file, parser.place(line, column), "mode '" + text + "'",
                   "use push, pull, wet, dry or 0, 1, 2, 3");
}

void read_sample(Parser& parser, std::size_t line) {
  if (parser.fields.size() == parser.width + 1 && parser.fields.back().empty()) parser.fields.pop_back();
  if (parser.fields.size() != parser.width)
    throw InputError(parser.file, parser.place(line),
                     std::to_string(parser.fields.size()) + " fields, not " + std::to_string(parser.width),
                     std::string("every row has as many fields as the first, by ") +
                         std::string(name_separator(parser.separator)));
  RawTrace& raw = parser.raw;
  const auto cell = [&](Role role) { return read_cell(parser, line, role); };
  if (parser.layout.has(kTime)) raw.time.push_back(cell(kTime));
  const double x = cell(kX);
  const double y = cell(kY);
  raw.position.emplace_back(x, y, cell(kZ));
  if (parser.layout.has(kQx)) raw.orientation.emplace_back(cell(kQx), cell(kQy), cell(kQz), cell(kQw));
  if (parser.layout.has(kMode)) raw.mode.push_back(read_mode(parser, line));
  raw.line.push_back(line);
}

bool is_number(const std::string& text) {
  return find_number(text) || find_comma_number(text);
}

/// Is this first row a header row? With columns named by the user, a row whose position is not made of
/// numbers is.
bool is_header_row(const Parser& parser) {
  if (parser.options.columns.empty()) return true;
  for (const Role role : {kX, kY, kZ}) {
    const auto column = static_cast<std::size_t>(parser.layout.column[role]);
    if (column < parser.fields.size() && is_number(parser.fields[column])) return false;
  }
  return true;
}

/// The rows that say how a file is built.
struct Preview {
  std::string_view comment;  // last comment line before the first row, without its sign
  std::size_t comment_line = 0;
  std::string_view row[2];  // the first two
  int num_rows = 0;
};

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%');
}

Preview look_at(std::string_view bytes) {
  Preview preview;
  LineReader lines(bytes);
  std::string_view line;
  while (preview.num_rows < 2 && lines.next(line)) {
    if (trim(line).empty()) continue;
    if (preview.num_rows == 0 && is_comment(line)) {
      preview.comment = line.substr(1);
      preview.comment_line = lines.line_number();
    } else {
      preview.row[preview.num_rows++] = line;
    }
  }
  return preview;
}

/// Names of columns that stand in a comment, as some programs write them above rows of numbers alone.
std::vector<std::string> find_commented_names(Parser& parser, const Preview& preview) {
  if (!parser.options.columns.empty() || preview.comment_line == 0 ||
      std::count_if(parser.fields.begin(), parser.fields.end(), is_number) < 3)
    return {};
  std::vector<std::string> names;
  const char separator = find_separator(preview.comment, preview.row[0]);
  if (!split_record(preview.comment, separator, names) || names.size() != parser.fields.size()) return {};
  parser.raw.notes.push_back("columns are named by the comment in line " +
                             std::to_string(preview.comment_line));
  return names;
}

/// Takes the first row: names of columns, or already a sample when the user or a comment named them.
void read_first_row(Parser& parser, std::size_t line, const Preview& preview) {
  if (parser.fields.size() > 1 && parser.fields.back().empty()) parser.fields.pop_back();
  parser.width = parser.fields.size();
  const std::vector<std::string>& columns = parser.options.columns;
  if (columns.size() > parser.width)
    throw InputError(
        parser.file, parser.place(line),
        std::to_string(columns.size()) + " columns are named but the row has " + std::to_string(parser.width),
        "name no more than there are");
  const std::vector<std::string> commented = find_commented_names(parser, preview);
  const std::vector<std::string>& names = !columns.empty()     ? columns
                                          : !commented.empty() ? commented
                                                               : parser.fields;
  parser.layout = find_layout(parser.file, parser.place(line), names, parser.options);
  if (!commented.empty() || !is_header_row(parser)) read_sample(parser, line);
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// What was not taken as the plain format has it.
void note_reading(Parser& parser) {
  std::vector<std::string>& notes = parser.raw.notes;
  if (!parser.layout.unusual.empty()) notes.push_back("columns read: " + join(parser.layout.unusual));
  if (!parser.layout.ignored.empty()) notes.push_back("columns not used: " + join(parser.layout.ignored));
  if (parser.comma_line != 0) notes.push_back("numbers have decimal commas");
  parser.raw.ignored_columns = parser.layout.ignored;
}

}  // namespace

RawTrace parse_csv(const std::string& file, const std::string& text, const TraceOptions& options) {
  Parser parser{file, options, {}, {}, {}, {}, 0};
  std::string_view bytes = text;
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // byte order mark
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    throw InputError(file, "line 1", "the text is UTF-16", "save it as UTF-8");
  const Preview preview = look_at(bytes);
  parser.separator = find_separator(preview.row[0], preview.row[1]);
  LineReader lines(bytes);
  std::string_view line;
  bool ours = false;
  bool in_body = false;  // past the comment lines
  while (lines.next(line)) {
    const std::size_t number = lines.line_number();
    if (!in_body && is_comment(line)) {
      read_header_line(parser, number, line.substr(1), ours);
      continue;
    }
    if (!in_body) check_body(parser, bytes.substr(lines.line_offset()));
    in_body = true;
    if (trim(line).empty()) continue;
    if (!split_record(line, parser.separator, parser.fields))
      throw InputError(file, parser.place(number), "a quoted field is not closed",
                       "close it, or remove the quotes");
    if (parser.width == 0)
      read_first_row(parser, number, preview);
    else
      read_sample(parser, number);
  }
  note_reading(parser);
  return std::move(parser.raw);
}

}  // namespace argil::device::internal
