#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

/// Many settings of one scenario.
struct Sweep {
  std::string file;
  std::string scenario;                      ///< base, its folder resolved
  std::vector<std::vector<Setting>> points;  ///< of each point, axes in the file's order
};

/// Reads a sweep: {"scenario": BASE, "grid": {"/pointer": [values], …}, "zip": {…}, "list": [{"/pointer":
/// value, …}, …], "sample": {"method": "random" | "halton", "count": n, "seed": s, "axes": {"/pointer": [low,
/// high], …}}}. grid: every combination, the last axis fastest; zip: lists of one length, taken together;
/// list: as it stands; sample: uniform in the box, independent or low-discrepancy [Halton1960], by a seed
/// that is 0 where it is not given. What is given of these is combined, each with each. In a point each key
/// of the scenario is set once. At most a million points, of 512 MiB together. Throws InputError, IoError.
Sweep load_sweep(const std::string& file);

/// A line of points.jsonl.
struct SweepPoint {
  std::int64_t index = 0;
  std::string id;        ///< of the run (Identity), so that a result is known to be this point's
  std::string scenario;  ///< relative to the folder of points.jsonl
  std::vector<Setting> settings;
};

/// A setting's value: a number that a double holds, a text as it is, anything else as JSON.
std::variant<std::string, double> parse_value(const Setting& setting);

/// What load_points() reads of a point at most.
inline constexpr std::size_t kLongestPoint = std::size_t{1} << 20;

std::string print_point(const SweepPoint& point);
/// Reads them all and checks that they are numbered from 0. Throws InputError with the line.
std::vector<SweepPoint> load_points(const std::string& file);

}  // namespace argil::scenario
