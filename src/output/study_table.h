#pragma once

#include <string>
#include <variant>
#include <vector>

namespace argil::output {

/// Table of a study: one row a run, columns of text or numbers. NaN: no such figure (an empty cell).
struct StudyTable {
  struct Column {
    std::string name;   ///< with its unit, as in force_error or cpu_s_per_s
    std::string units;  ///< SI unit, "1" for a pure number, "-" for text
    std::string about;
    bool is_exact = false;  ///< numbers are printed so that they read back equal, else in nine digits
  };
  using Cell = std::variant<std::string, double>;

  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<std::pair<std::string, std::string>> provenance;  ///< name → text of one line
};

/// Comma-separated values [RFC 4180]: provenance as comment lines (#), names, then a line a row. Throws
/// IoError.
void write_csv(const StudyTable& table, const std::string& file);

/// One dataset a column, provenance as attributes of the root. A column with a text in it is one of texts
/// (UTF-8 of any length), its numbers as in the CSV. Throws IoError.
void write_hdf5(const StudyTable& table, const std::string& file);

}  // namespace argil::output
