#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "study/study_output.h"
#include "support/scene_files.h"
#include "support/temp_folder.h"

namespace argil::study {

using Row = std::map<std::string, std::string>;

inline std::string read_text(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Cells of a line of comma-separated values; quoted ones may hold commas.
inline std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"')
      is_quoted = !is_quoted;
    else if (c == ',' && !is_quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

/// Rows of a table by column.
inline std::vector<Row> read_table(const std::string& file) {
  std::istringstream in(read_text(file));
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == '#') continue;
    const std::vector<std::string> cells = split(line);
    if (names.empty()) {
      names = cells;
      continue;
    }
    for (std::size_t c = 0; c < names.size(); ++c) {
      if (c == 0) rows.emplace_back();
      rows.back()[names[c]] = cells.at(c);
    }
  }
  return rows;
}

/// A box of clay that a small sphere pokes.
class Study : public testing::Test {
 protected:
  test::TempFolder folder;

  void SetUp() override {
    test::write_press_trace(folder / "press.csv", 0.048, 0.044, 0.4, "push");
    test::write_text(folder / "scene.json", R"({"about": "a box poked from above",
      "body": {"shape": {"kind": "box", "size_m": 0.04, "target_tets": 150, "skin_triangles": 0},
               "fixed": [{"kind": "plane", "normal": [0, 0, 1], "offset_m": 0}]},
      "material": {"youngs_modulus_Pa": 2e4, "poissons_ratio": 0.3, "plasticity": {"enabled": false},
                   "clay_kernel": {"form": "off"}},
      "tool": {"shape": {"kind": "sphere", "radius_m": 0.006, "subdivisions": 2}, "mode": "push"},
      "contact": {"law": "pairs", "vertex_face_stiffness_N_per_m": 20, "edge_edge_stiffness_N_per_m": 20},
      "dynamics": {"rayleigh_stiffness_s": 0.002},
      "haptics": {"frame_period_ticks": 50}, "trace": {"file": "press.csv"}})");
  }
  StudyOptions options(const std::string& json) const {
    StudyOptions o;
    o.study = test::write_text(folder / "study.json", json);
    o.output = folder / "table";
    o.cases.program = ARGIL_BINARY;
    o.cases.quiet = true;
    o.cases.jobs = 2;
    return o;
  }
  std::vector<Row> table() const { return read_table(folder / "table.csv"); }
};

/// A map of one place.
inline std::string one_place(const std::string& settings, const std::string& pointer,
                             const std::string& value,
                             const std::string& reference = R"("/dynamics/iteration": "newton")",
                             const std::string& more = "") {
  return R"({"about": "one place", "scenario": "scene.json", "settings": {)" + more + settings +
         R"(}, "x": {"name": "x", "pointers": [")" + pointer + R"("], "values": [)" + value +
         R"(]}, "reference": {)" + reference + "}}";
}

}  // namespace argil::study
