#pragma once

// What the reader of CSV traces knows while it goes through a file, and its parts.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "device/trace_columns.h"
#include "device/trace_raw.h"

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
  std::size_t num_placeless = 0;  // rows whose x, y and z are empty
  std::size_t placeless_line = 0;
  std::size_t num_short = 0;  // rows that end before the last column, behind all that is read
  std::size_t short_line = 0;
  std::string header_unit = {};  // of length, as our own header says; empty: not said
  bool is_calendar = false;      // times are dates or times of day
  double per_second = 1.0;       // of the numbers in the time column
  std::int64_t origin = 0;       // times count from here, in their unit
  double radians = 1.0;          // per unit of the angles

  std::string place(std::size_t line) const { return "line " + std::to_string(line); }
  std::string place(std::size_t line, int column) const {
    return place(line) + ", column " + std::to_string(column + 1);
  }
};

/// A comment line before the first row. The header of our own format begins "# argil-trace: 1" and is read
/// strictly (`ours`); comments of other programs are skipped.
void read_header_line(Parser& parser, std::size_t line, std::string_view comment, bool& ours);

/// Refuses a body that is not the one whose hash the header states.
void check_body(const Parser& parser, std::string_view body);

/// Does a cell hold a number, with a point or a comma?
bool is_number(const std::string& text);

/// Takes a row under the names that says the columns' units. False where this row is none.
bool take_units_row(Parser& parser);

/// Takes the fields as a sample; the first chooses the units.
void read_sample(Parser& parser, std::size_t line);

}  // namespace argil::device::internal
