#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace argil::study {

/// Writes points.jsonl: one line a point with its index, its id and its settings. Each point's scenario is
/// checked, and each point is another run. Throws InputError, also when `points` has no ending, or names the
/// sweep or a file that a point reads; IoError.
int expand_sweep(const std::string& sweep, const std::string& points);

/// What of a sweep one call runs.
struct SweepRun {
  std::string points;                 ///< points.jsonl
  std::optional<std::int64_t> index;  ///< of the block; none: the scheduler's SLURM_ARRAY_TASK_ID
  std::int64_t block = 1;             ///< points in a block: block i has the points from i·block on
  int threads = 1;
};

/// Runs the points of a block, each into FOLDER/NNNNNN.h5 beside points.jsonl (its name without .jsonl): to a
/// .part first, which a later call resumes, synced and renamed when it ends. A point whose file opens, is
/// complete and has its id is skipped, and one that another process computes is an IoError. A refused point
/// leaves NNNNNN.refused with the reason. Returns kInterrupted after a signal, which ends it within the point
/// or before the next, else kDone, also when a run failed: `collect` says so.
int run_sweep(const SweepRun& run);

/// Prints the indices of the blocks with points that did not end, in the syntax of sbatch --array.
int print_missing(const std::string& points, std::int64_t block);

/// One row a point, in the order of their indices: settings, outcome with reason, and figures; as TABLE.csv
/// and TABLE.h5. Wall clock is left out, so that equal runs give equal tables. Throws InputError when one of
/// these is the points, a result or a file that a point reads.
int collect_sweep(const std::string& points, const std::string& table);

}  // namespace argil::study
