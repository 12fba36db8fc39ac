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

  /// Takes the memory for sums of so many items, whichever runs are visited.
  void prepare(std::ptrdiff_t count) const {
    m_sums.reserve(static_cast<std::size_t>(count_all_runs(count)));
  }
  /// body(begin, end) for every run; its number is added to the sum that is returned. No allocation after the
  /// first call of one count.
  template <class Body>
  double sum(std::ptrdiff_t count, Body body) const {
    prepare(count);
    m_sums.resize(static_cast<std::size_t>(count_runs(count)));
    double* sums = m_sums.data();
    each_run(count, [sums, &body](std::ptrdiff_t i, std::ptrdiff_t begin, std::ptrdiff_t end) {
      sums[i] = body(begin, end);
    });
    double total = 0.0;
    for (const double s : m_sums) total += s;
    return total;
  }
  template <class Body>
  void each(std::ptrdiff_t count, Body body) const {
    each_run(count, [&body](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) { body(begin, end); });
  }
  /// body(i, begin, end) for the i-th of the runs that are visited.
  template <class Body>
  void each_run(std::ptrdiff_t count, Body body) const {
    const std::vector<int>* visited = m_visited;
    parallel_for(count_runs(count), m_threads, [visited, count, &body](std::ptrdiff_t i) {
      const std::ptrdiff_t run = visited ? (*visited)[static_cast<std::size_t>(i)] : i;
      body(i, run * kLength, std::min((run + 1) * kLength, count));
    });
  }
  /// The same, one run after the other by the calling thread.
  template <class Body>
  void each_in_order(std::ptrdiff_t count, Body body) const {
    for (std::ptrdiff_t i = 0; i < count_runs(count); ++i) {
      const std::ptrdiff_t run = m_visited ? (*m_visited)[static_cast<std::size_t>(i)] : i;
      body(run * kLength, std::min((run + 1) * kLength, count));
    }
  }
  /// How many runs are visited.
  std::ptrdiff_t count_runs(std::ptrdiff_t count) const {
    return m_visited ? static_cast<std::ptrdiff_t>(m_visited->size()) : count_all_runs(count);
  }
  static constexpr std::ptrdiff_t count_all_runs(std::ptrdiff_t count) {
    return (count + kLength - 1) / kLength;
  }
  /// From now on only these runs, increasing; the list must outlive them. Null: all.
  void visit(const std::vector<int>* runs) { m_visited = runs; }
  const std::vector<int>* visited() const { return m_visited; }
  static constexpr std::ptrdiff_t kLength = 8;

 private:
  int m_threads;
  const std::vector<int>* m_visited = nullptr;
  mutable std::vector<double> m_sums;
};

}  // namespace argil
