// Where a table begins in a file: below free text that its program wrote above it.

#include <algorithm>
#include <vector>

#include "device/csv.h"
#include "device/trace_parser.h"

namespace argil::device::internal {
namespace {

constexpr std::size_t kMostLines = 200;  // are searched; headers have some dozen

struct Line {
  std::string_view text;
  std::size_t number = 0;
};

/// The first lines without comments and empty ones.
std::vector<Line> read_lines(std::string_view bytes) {
  std::vector<Line> found;
  LineReader lines(bytes);
  std::string_view line;
  while (found.size() < kMostLines + 2 && lines.next(line))
    if (!trim(line).empty() && !is_comment(line)) found.push_back({line, lines.line_number()});
  return found;
}

/// The text of line i, or nothing.
std::string_view text_of(const std::vector<Line>& lines, std::size_t i) {
  return i < lines.size() ? lines[i].text : std::string_view();
}

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> fields;
  if (trim(line).empty() || !split_record(line, separator, fields)) fields.clear();
  return fields;
}

/// Do its cells of the place pass `test`?
template <class Test>
bool holds_place(const std::vector<std::string>& fields, const std::array<int, kNumRoles>& column,
                 Test test) {
  return std::all_of(column.begin() + kX, column.begin() + kZ + 1, [&](int at) {
    return at >= 0 && static_cast<std::size_t>(at) < fields.size() &&
           test(fields[static_cast<std::size_t>(at)]);
  });
}

bool is_place_cell(const std::string& cell) {
  return is_number(cell) || is_lost(cell);
}

bool is_unit_cell(const std::string& cell) {
  return find_length_unit(strip_brackets(cell)).has_value();
}

/// Are both rows of as many numbers, three or more?
bool are_numbers(const std::vector<std::string>& row, const std::vector<std::string>& next) {
  return row.size() >= 3 && row.size() == next.size() && std::all_of(row.begin(), row.end(), is_number) &&
         std::all_of(next.begin(), next.end(), is_number);
}

/// Does line i name columns of the next row, or of the one behind a row of units?
bool names_next_row(const std::vector<Line>& lines, std::size_t i, char separator) {
  const std::vector<std::string> names = split(lines[i].text, separator);
  const std::array<int, kNumRoles> column = find_columns(names);
  const auto is_sample = [&](std::size_t row) {
    std::vector<std::string> fields = split(text_of(lines, row), separator);
    join_split_date(fields, column[kTime], names.size());
    return fields.size() <= names.size() + 1 && holds_place(fields, column, is_place_cell);
  };
  return is_sample(i + 1) || is_sample(i + 2);
}

/// The first line that names columns of rows of numbers, and what separates them.
std::size_t find_names(const std::vector<Line>& lines, char& separator) {
  for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i) {
    const char likely = find_separator(lines[i].text, text_of(lines, i + 1));
    if (are_numbers(split(lines[i].text, likely), split(text_of(lines, i + 1), likely))) break;
    for (const char candidate : {likely, ';', '\t', ',', ' '})
      if (names_next_row(lines, i, candidate)) {
        separator = candidate;
        return i;
      }
  }
  return 0;
}

/// The first row of numbers under the user's columns, or the rows of names and units above it.
std::size_t find_numbers(const std::vector<Line>& lines, const std::vector<std::string>& names,
                         char& separator) {
  const std::array<int, kNumRoles> column = find_columns(names);
  for (std::size_t i = 0; i < std::min(lines.size(), kMostLines); ++i) {
    const char candidate = find_separator(lines[i].text, text_of(lines, i + 1));
    const auto row = [&](std::size_t at) { return split(lines[at].text, candidate); };
    if (row(i).size() < names.size() || !holds_place(row(i), column, is_number)) continue;
    separator = candidate;
    std::size_t start = i;
    while (start > 0 && holds_place(row(start - 1), column, is_lost)) --start;
    if (start > 0 && holds_place(row(start - 1), column, is_unit_cell)) --start;
    if (start > 0 && row(start - 1).size() >= names.size()) --start;
    return start;
  }
  return 0;
}

}  // namespace

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%');
}

Start find_start(std::string_view bytes, const TraceOptions& options) {
  const std::vector<Line> lines = read_lines(bytes);
  Start start;
  if (lines.empty()) return start;
  const bool is_ours = trim(bytes.substr(0, bytes.find(':'))) == "# argil-trace";
  start.separator = find_separator(lines[0].text, text_of(lines, 1));
  std::size_t first = 0;
  if (!is_ours && options.columns.empty()) {
    first = find_names(lines, start.separator);
  } else if (!is_ours) {
    first = find_numbers(lines, options.columns, start.separator);
  }
  start.line = lines[first].number;
  start.num_above = first;
  start.above = lines[0].number;
  start.row[0] = lines[first].text;
  start.row[1] = text_of(lines, first + 1);
  return start;
}

}  // namespace argil::device::internal
