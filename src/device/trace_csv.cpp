#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "device/csv.h"
#include "device/trace_parser.h"

namespace argil::device::internal {
namespace {

/// Is this first row a header row? With columns named by the user, a row whose position is not made of
/// numbers is.
bool is_header_row(const Parser& parser) {
  if (parser.options.columns.empty()) return true;
  for (const Role role : {kX, kY, kZ}) {
    const auto column = static_cast<std::size_t>(parser.layout.column[role]);
    if (column < parser.fields.size() && (is_number(parser.fields[column]) || is_lost(parser.fields[column])))
      return false;
  }
  return true;
}

struct Comment {
  std::string_view text;  // without its sign
  std::size_t line = 0;
};

/// With columns named by the user, before the first sample: another row of names.
bool is_second_header(const Parser& parser) {
  return !parser.options.columns.empty() && parser.raw.line.empty() && names_a_place(parser.fields);
}

/// Those above the first row.
std::vector<Comment> read_comments(std::string_view bytes, const Start& start) {
  std::vector<Comment> comments;
  LineReader lines(bytes);
  std::string_view line;
  while (lines.next(line) && (start.line == 0 || lines.line_number() < start.line))
    if (is_comment(line)) comments.push_back({line.substr(1), lines.line_number()});
  return comments;
}

/// Names of columns that stand in a comment, as some programs write them above rows of numbers alone: "x y
/// z", or behind a colon.
std::vector<std::string> find_commented_names(Parser& parser, const Start& start,
                                              const std::vector<Comment>& comments) {
  if (!parser.options.columns.empty() ||
      std::count_if(parser.fields.begin(), parser.fields.end(), is_number) < 3)
    return {};
  std::vector<std::string> names;
  for (auto comment = comments.rbegin(); comment != comments.rend(); ++comment) {
    const std::string_view behind_colon = comment->text.substr(comment->text.rfind(':') + 1);
    for (const std::string_view text : {comment->text, behind_colon}) {
      const char separator = find_separator(text, start.row[0]);
      if (!split_record(text, separator, names) || names.size() != parser.fields.size() ||
          !names_a_place(names))
        continue;
      parser.raw.notes.push_back("columns are named by the comment in line " + std::to_string(comment->line));
      return names;
    }
  }
  return {};
}

/// Refuses numbers that nothing names, with the names that they are likely to have: a time that grows, a
/// place, and what has the length of a unit quaternion.
[[noreturn]] void refuse_nameless(const Parser& parser, std::size_t line, std::string_view next_row) {
  constexpr double kMaxUnitError = 1e-3;
  std::vector<double> number;
  for (const std::string& field : parser.fields) number.push_back(find_number(field).value_or(0.0));
  std::vector<std::string> next;
  const bool has_next = !next_row.empty() && split_record(next_row, parser.separator, next);
  const std::size_t count = number.size();
  const auto ends_with_quaternion = [&](std::size_t before) {
    double squares = 0.0;
    for (std::size_t i = before; i < before + 4 && before + 4 <= count; ++i) squares += number[i] * number[i];
    return std::abs(std::sqrt(squares) - 1.0) <= kMaxUnitError;
  };
  const bool has_time = count > 3 && has_next && find_number(next[0]).value_or(number[0]) > number[0] &&
                        !(count == 7 && ends_with_quaternion(3));
  std::string names = has_time ? R"("t", "x", "y", "z")" : R"("x", "y", "z")";
  const bool has_quaternion = ends_with_quaternion(has_time ? 4 : 3);
  if (has_quaternion) names += R"(, "qx", "qy", "qz", "qw")";
  throw InputError(parser.file, parser.place(line),
                   "no columns x, y, z: nothing names these " + std::to_string(count) + " numbers",
                   "name them from the left by /trace/columns, for instance [" + names + "]" +
                       (has_quaternion ? ", or with \"qw\" before \"qx\"" : ""));
}

/// Takes the first row: names of columns, or already a sample when the user or a comment named them.
void read_first_row(Parser& parser, const Start& start, const std::vector<Comment>& comments) {
  const std::size_t line = start.line;
  if (parser.fields.size() > 1 && parser.fields.back().empty()) parser.fields.pop_back();
  parser.width = parser.fields.size();
  const std::vector<std::string>& columns = parser.options.columns;
  if (columns.size() > parser.width)
    throw InputError(
        parser.file, parser.place(line),
        std::to_string(columns.size()) + " columns are named but the row has " + std::to_string(parser.width),
        "name no more than there are");
  const std::vector<std::string> commented = find_commented_names(parser, start, comments);
  const bool are_all_numbers = std::all_of(parser.fields.begin(), parser.fields.end(), is_number);
  if (columns.empty() && commented.empty() && parser.width > 2 && are_all_numbers)
    refuse_nameless(parser, line, start.row[1]);
  const std::vector<std::string>& names = !columns.empty()     ? columns
                                          : !commented.empty() ? commented
                                                               : parser.fields;
  parser.layout = find_layout(parser.file, parser.place(line), names, parser.options);
  if (!commented.empty() || !is_header_row(parser)) read_sample(parser, line);
}

/// "rows without a place: 5, the first in line 3".
void note_count(Parser& parser, const std::string& what, std::size_t count, std::size_t first) {
  if (count > 0)
    parser.raw.notes.push_back(what + ": " + std::to_string(count) + ", the first in " + parser.place(first));
}

/// Free text above the table.
void note_above(Parser& parser, const Start& start) {
  if (start.num_above > 0)
    parser.raw.notes.push_back(std::to_string(start.num_above) + (start.num_above == 1 ? " line" : " lines") +
                               " above the " + (parser.options.columns.empty() ? "names" : "table") +
                               ", from " + parser.place(start.above) +
                               (start.num_above == 1 ? ", is not used" : ", are not used"));
}

/// What was not taken as the plain format has it.
void note_reading(Parser& parser) {
  std::vector<std::string>& notes = parser.raw.notes;
  if (!parser.layout.unusual.empty()) notes.push_back("columns read: " + join(parser.layout.unusual));
  if (!parser.layout.ignored.empty()) {
    std::string note = "columns not used: " + join(parser.layout.ignored);
    std::string_view last;
    for (const std::string& name : parser.layout.ignored) {
      const std::string_view remedy = find_remedy(name);
      if (!remedy.empty() && remedy != last) note += "; " + std::string(remedy);
      if (!remedy.empty()) last = remedy;
    }
    notes.push_back(note);
  }
  if (parser.comma_line != 0) notes.emplace_back("numbers have decimal commas");
  note_count(parser, "rows that lack columns which are not used", parser.num_short, parser.short_line);
  note_count(parser, "rows without a place, left out", parser.num_placeless, parser.placeless_line);
  note_count(parser, "comment lines among the rows, not used", parser.num_comments, parser.comment_line);
  note_times(parser);
  parser.raw.ignored_columns = parser.layout.ignored;
}

}  // namespace

RawTrace parse_csv(const std::string& file, const std::string& text, const TraceOptions& options,
                   bool are_rows) {
  Parser parser{file, options};
  parser.raw.are_rows = are_rows;
  const std::string_view bytes = text;
  const Start start = find_start(bytes, options);
  const std::vector<Comment> comments = read_comments(bytes, start);
  parser.separator = start.separator;
  LineReader lines(bytes);
  std::string_view line;
  bool ours = false;
  bool in_body = false;  // past the comment lines
  while (lines.next(line)) {
    const std::size_t number = lines.line_number();
    if (number < start.line && !is_comment(line) && !ours) continue;
    if (!in_body && is_comment(line)) {
      read_header_line(parser, number, line.substr(1), ours);
      continue;
    }
    if (!in_body && !ours && trim(line).empty()) continue;
    if (!in_body) check_body(parser, bytes.substr(lines.line_offset()));
    in_body = true;
    if (trim(line).empty()) continue;
    if (is_comment(line)) {
      if (parser.num_comments++ == 0) parser.comment_line = number;
      continue;
    }
    if (!split_record(line, parser.separator, parser.fields))
      throw InputError(file, parser.place(number), "a quoted field is not closed",
                       "close it, or remove the quotes");
    if (parser.width == 0)
      read_first_row(parser, start, comments);
    else if (is_second_header(parser))
      parser.raw.notes.push_back(parser.place(number) + " holds names, and is not used");
    else if (!take_units_row(parser))
      read_sample(parser, number);
  }
  if (parser.raw.line.size() < 2 && parser.num_placeless > 0)
    throw InputError(file, parser.place(parser.placeless_line),
                     std::to_string(parser.num_placeless) + " of " +
                         std::to_string(parser.num_placeless + parser.raw.line.size()) +
                         " rows have no place, as here",
                     "a trace needs two or more rows with numbers in x, y and z");
  note_above(parser, start);
  note_reading(parser);
  return std::move(parser.raw);
}

}  // namespace argil::device::internal
