#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace argil {

/// Items 0 … count−1 in runs of fixed length, which threads share. A sum is that of the runs' sums, added in
/// order, so that no bits depend on the number of threads.
class OrderedRuns {
 public:
  explicit OrderedRuns(int threads) : m_threads(threads) {}

  /// body(begin, end) for every run; its number is added to the sum that is returned. No allocation after the
  /// first call of one size.
  template <class Body>
  double sum(std::ptrdiff_t count, Body body) {
    const std::ptrdiff_t runs = count_runs(count);
    prepare(count);
    double* sums = m_sums.data();
    parallel_for(runs, m_threads, [sums, count, &body](std::ptrdiff_t run) {
      sums[run] = body(run * kLength, std::min((run + 1) * kLength, count));
    });
    double total = 0.0;
    for (const double s : m_sums) total += s;
    return total;
  }
  template <class Body>
  void each(std::ptrdiff_t count, Body body) const {
    each_run(count, [&body](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) { body(begin, end); });
  }
  /// body(run, begin, end) for every run.
  template <class Body>
  void each_run(std::ptrdiff_t count, Body body) const {
    parallel_for(count_runs(count), m_threads, [count, &body](std::ptrdiff_t run) {
      body(run, run * kLength, std::min((run + 1) * kLength, count));
    });
  }
  static std::ptrdiff_t count_runs(std::ptrdiff_t count) { return (count + kLength - 1) / kLength; }
  /// Before a first sum of this many items in a team.
  void prepare(std::ptrdiff_t count) {
    const auto runs = static_cast<std::size_t>(count_runs(count));
    if (m_sums.size() != runs) m_sums.resize(runs);
  }

 private:
  static constexpr std::ptrdiff_t kLength = 32;
  int m_threads;
  std::vector<double> m_sums;
};

}  // namespace argil
