#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/types.h"

namespace argil::output {

/// How far two values a (of the first file) and b of a dataset may lie apart: |a − b| ≤ absolute +
/// relative·|a| + of_largest·max|a|. Within any tolerance an infinity is equal to itself only.
struct Tolerance {
  std::string dataset;      ///< path from the root; * stands for any text: "/frames/*/position"
  double relative = 0.0;    ///< ≥ 0
  double absolute = 0.0;    ///< ≥ 0, in the dataset's unit
  double of_largest = 0.0;  ///< ≥ 0, of the dataset's largest |a|
};

struct CompareOptions {
  /// The first that fits a dataset counts; without one, values must have the same bits. A frame's state_hash,
  /// which tells of every bit of the state, is left out only when a tolerance above 0 counts for a dataset of
  /// that frame.
  std::vector<Tolerance> tolerances;
  /// Paths that are left out, * as above, with everything in them; of an attribute "/frames/* attribute
  /// time". /timing, /checkpoint and /packed always are.
  std::vector<std::string> ignore;
  std::string file;  ///< that these rules are from, to be named in errors; empty: none
};

/// One dataset, attribute or group that is not the same in both files.
struct Difference {
  std::string object;        ///< "/haptic/force", "/frames/000003 attribute time"
  std::string what;          ///< shapes, values, which file lacks it
  std::optional<Tick> tick;  ///< first tick that differs, for what changes with time
  std::uint64_t count = 0;   ///< values that differ
};

struct CompareReport {
  std::vector<Difference> differences;  ///< what does not change with time first, then by tick, then by path
  std::uint64_t num_compared = 0;       ///< datasets and attributes looked at
  std::uint64_t num_hashes = 0;         ///< state hashes among them
  bool is_equal() const { return differences.empty(); }
};

/// Compares everything in two result files except /timing, /checkpoint and /packed: names, shapes, types,
/// attributes, values. NaN equals nothing, not even itself. Without tolerances that is exact twice: every
/// value and every frame's hash of the whole state, the last frame's being that of the end. Throws IoError or
/// InputError when a file cannot be used, InputError for a rule that fits nothing in either file.
CompareReport compare_results(const std::string& file_a, const std::string& file_b,
                              const CompareOptions& options);

/// The report for a person; the first line names the first differing tick and dataset. Unless it is
/// `verbose`, hashes are left out, which differ where anything does, and of other differences all but the
/// first few.
std::string to_string(const CompareReport& report, bool verbose = true);

}  // namespace argil::output
