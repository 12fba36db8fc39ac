#include "output/study_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/check.h"
#include "base/error.h"
#include "hdf5/file.h"

namespace argil::output {
namespace {

std::string quote(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string print_cell(const StudyTable::Cell& cell, const StudyTable::Column& column) {
  constexpr int kUsual = 9;
  constexpr int kEnough = 17;  // for any double
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  const double value = std::get<double>(cell);
  if (std::isnan(value)) return "";
  char digits[32];
  for (int count = kUsual; count <= kEnough; ++count) {
    std::snprintf(digits, sizeof digits, "%.*g", count, value);
    if (!column.is_exact || std::strtod(digits, nullptr) == value) break;
  }
  return digits;
}

bool is_text(const StudyTable::Cell& cell) {
  return std::holds_alternative<std::string>(cell);
}

}  // namespace

void write_csv(const StudyTable& table, const std::string& file) {
  std::ofstream out(file);
  for (const auto& [name, text] : table.provenance) out << "# " << name << ": " << text << '\n';
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    out << (c ? "," : "") << quote(table.columns[c].name);
  out << '\n';
  for (const auto& row : table.rows) {
    ARGIL_ASSERT(row.size() == table.columns.size(), row.size());
    for (std::size_t c = 0; c < row.size(); ++c)
      out << (c ? "," : "") << quote(print_cell(row[c], table.columns[c]));
    out << '\n';
  }
  out.close();
  if (!out) throw IoError(file, "could not be written");
}

void write_hdf5(const StudyTable& table, const std::string& file) {
  hdf5::File out = hdf5::File::create(file);
  hdf5::Group root = out.root();
  root.write_attribute("format", "argil-study");
  root.write_attribute("format_version", std::int64_t{2});
  for (const auto& [name, text] : table.provenance) root.write_attribute(name, text);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const StudyTable::Column& column = table.columns[c];
    const hdf5::Label label{column.units.c_str(), column.about.c_str()};
    const bool has_text =
        std::any_of(table.rows.begin(), table.rows.end(), [c](const auto& row) { return is_text(row[c]); });
    if (has_text) {
      std::vector<std::string> texts;
      for (const auto& row : table.rows) texts.push_back(print_cell(row[c], column));
      root.write_texts(column.name, texts, label);
    } else {
      std::vector<double> numbers;
      for (const auto& row : table.rows) numbers.push_back(std::get<double>(row[c]));
      root.write_array(column.name, numbers.data(), {numbers.size()}, false, label);
    }
  }
  out.close();
}

}  // namespace argil::output
