#pragma once

#include <cstdint>
#include <string>
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
/// list: as it stands; sample: uniform in the box, independent or low-discrepancy [Halton1960]. What is given
/// of these is combined, each with each. At most a million points. Throws InputError, IoError.
Sweep load_sweep(const std::string& file);

/// A line of points.jsonl.
struct SweepPoint {
  std::int64_t index = 0;
  std::string id;        ///< of the run (Identity), so that a result is known to be this point's
  std::string scenario;  ///< relative to the folder of points.jsonl
  std::vector<Setting> settings;
};

std::string print_point(const SweepPoint& point);
/// Reads them all and checks that they are numbered from 0. Throws InputError with the line.
std::vector<SweepPoint> load_points(const std::string& file);

}  // namespace argil::scenario
