#pragma once

// What the reader of CSV traces knows while it goes through a file, and its parts.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "device/trace_columns.h"
#include "device/trace_raw.h"
#include "device/trace_units.h"

namespace argil::device::internal {

struct Parser {
  const std::string& file;
  const TraceOptions& options;
  RawTrace raw = {};
  std::string body_sha256 = {};  // stated by the header; empty: not stated
  std::vector<std::string> fields = {};
  Layout layout = {};
  std::size_t width = 0;
  char separator = ',';
  std::size_t comma_line = 0;     // first line with a decimal comma; 0: none yet
  std::size_t point_line = 0;     // with a decimal point
  std::size_t num_placeless = 0;  // rows whose x, y and z are empty or no number
  std::size_t placeless_line = 0;
  std::size_t num_short = 0;  // rows that end before the last column, behind all that is read
  std::size_t short_line = 0;
  std::string header_unit = {};  // of length, as our own header says; empty: not said
  std::size_t num_comments = 0;  // between rows and behind them
  std::size_t comment_line = 0;
  bool is_calendar = false;  // times are dates or times of day
  double per_second = 1.0;   // of the numbers in the time column
  Moment origin = {};        // times count from here, in their unit
  Moment clock = {};         // the last time of day
  std::int64_t num_midnights = 0;
  std::size_t midnight_line = 0;
  double radians = 1.0;  // per unit of the angles

  const std::string& cell(Role role) const { return fields[static_cast<std::size_t>(layout.column[role])]; }
  std::string place(std::size_t line) const {
    return raw.are_rows ? "row " + std::to_string(line - 1) : "line " + std::to_string(line);
  }
  std::string place(std::size_t line, int column) const {
    return place(line) + ", column " + std::to_string(column + 1);
  }
};

/// A comment line before the first row. The header of our own format begins "# argil-trace: 1" and is read
/// strictly (`ours`); comments of other programs are skipped.
void read_header_line(Parser& parser, std::size_t line, std::string_view comment, bool& ours);

/// Refuses a body that is not the one whose hash the header states.
void check_body(const Parser& parser, std::string_view body);

/// Is a line of a table left to people?
bool is_comment(std::string_view line);

/// The row from which a table is read: its names or, where something else names the columns, its first
/// sample. Lines above it are free text.
struct Start {
  std::size_t line = 0;       // from 1; 0: there is none
  std::size_t num_above = 0;  // lines of free text
  std::size_t above = 0;      // the first of them
  std::string_view row[2];    // that row and the next
  char separator = ',';
};
Start find_start(std::string_view bytes, const TraceOptions& options);

/// Does a cell hold a number, with a point or a comma?
bool is_number(const std::string& text);

/// Puts a date and a time of day that a blank, or the table's separator, made two cells of into one again.
void join_split_date(std::vector<std::string>& fields, int time_column, std::size_t width);

/// The number of a cell, with a decimal point or a decimal comma, but one of them in the whole file.
double read_cell(Parser& parser, std::size_t line, Role role);

/// A note that a key of the options stands above the unit that a column's name says.
void note_key(Parser& parser, std::string_view key, std::string_view stated);

/// How times are written, by the first sample.
void choose_time_unit(Parser& parser, std::size_t line);

/// [s], from the first sample where it is a date or a large number.
double read_time(Parser& parser, std::size_t line);

/// Of dates and times of day: what was made of them.
void note_times(Parser& parser);

/// Takes a row under the names that says the columns' units. False where this row is none.
bool take_units_row(Parser& parser);

/// Takes the fields as a sample; the first chooses the units.
void read_sample(Parser& parser, std::size_t line);

}  // namespace argil::device::internal
