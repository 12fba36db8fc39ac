#include "output/study_table.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "base/check.h"
#include "base/error.h"
#include "hdf5/file.h"

namespace argil::output {
namespace {

std::string quote(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

std::string print_cell(const StudyTable::Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return quote(*text);
  const double value = std::get<double>(cell);
  if (std::isnan(value)) return "";
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.9g", value);
  return digits;
}

}  // namespace

void write_csv(const StudyTable& table, const std::string& file) {
  std::ofstream out(file);
  for (const auto& [name, text] : table.provenance) out << "# " << name << ": " << text << '\n';
  for (std::size_t c = 0; c < table.columns.size(); ++c) out << (c ? "," : "") << table.columns[c].name;
  out << '\n';
  for (const auto& row : table.rows) {
    ARGIL_ASSERT(row.size() == table.columns.size(), row.size());
    for (std::size_t c = 0; c < row.size(); ++c) out << (c ? "," : "") << print_cell(row[c]);
    out << '\n';
  }
  out.close();
  if (!out) throw IoError(file, "could not be written");
}

void write_hdf5(const StudyTable& table, const std::string& file) {
  hdf5::File out = hdf5::File::create(file);
  hdf5::Group root = out.root();
  root.write_attribute("format", "argil-study");
  root.write_attribute("format_version", std::int64_t{1});
  for (const auto& [name, text] : table.provenance) root.write_attribute(name, text);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const StudyTable::Column& column = table.columns[c];
    const hdf5::Label label{column.units.c_str(), column.about.c_str()};
    std::vector<double> numbers;
    std::string lines;
    for (const auto& row : table.rows) {
      if (const auto* text = std::get_if<std::string>(&row[c]))
        lines += *text + '\n';
      else
        numbers.push_back(std::get<double>(row[c]));
    }
    if (numbers.empty())
      root.write_string(column.name, lines, label);
    else
      root.write_array(column.name, numbers.data(), {numbers.size()}, false, label);
  }
  out.close();
}

}  // namespace argil::output
