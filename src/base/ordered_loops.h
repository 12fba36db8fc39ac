#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace argil {

/// A loop over all of something, or over those of a list, that threads share. No bits depend on their number:
/// sums are those of blocks of fixed length, added in order. No allocation after the first call of one count.
class RestrictedLoop {
 public:
  /// From now on only those of the list, increasing; it must outlive the calls. Null: all.
  void restrict_to(const std::vector<int>* list) { m_list = list; }
  const std::vector<int>* list() const { return m_list; }

 protected:
  explicit RestrictedLoop(int threads) : m_threads(threads) {}

  std::ptrdiff_t size(std::ptrdiff_t count) const {
    return m_list ? static_cast<std::ptrdiff_t>(m_list->size()) : count;
  }
  std::ptrdiff_t at(std::ptrdiff_t i) const { return m_list ? (*m_list)[static_cast<std::size_t>(i)] : i; }
  /// What body(i) returns of each block i, in order.
  template <class Body>
  const std::vector<double>& find_of_blocks(std::ptrdiff_t num_blocks, Body body) const {
    m_of_block.resize(static_cast<std::size_t>(num_blocks));
    double* of_block = m_of_block.data();
    parallel_for(num_blocks, m_threads, [of_block, &body](std::ptrdiff_t i) { of_block[i] = body(i); });
    return m_of_block;
  }
  static double add_up(const std::vector<double>& of_blocks) {
    double total = 0.0;
    for (const double of_block : of_blocks) total += of_block;
    return total;
  }

  int m_threads;
  const std::vector<int>* m_list = nullptr;
  mutable std::vector<double> m_of_block;
};

/// One by one: 0 … count−1, or those of a list. A block is so many that follow one another in it.
class OrderedItems : public RestrictedLoop {
 public:
  /// `least_shared`: fewer items stay with the calling thread.
  explicit OrderedItems(int threads, std::ptrdiff_t least_shared = 0)
      : RestrictedLoop(threads), m_least_shared(least_shared) {}

  /// Takes the memory for sums over so many items, whichever are in the list.
  void prepare(std::ptrdiff_t count) const {
    m_of_block.reserve(static_cast<std::size_t>(count_blocks(count)));
  }
  /// body(i) for every item.
  template <class Body>
  void each(std::ptrdiff_t count, Body body) const {
    const std::ptrdiff_t num_items = size(count);
    const int threads = num_items < m_least_shared ? 1 : m_threads;
    if (!m_list) {
      parallel_for(num_items, threads, body);
      return;
    }
    const int* items = m_list->data();
    parallel_for(num_items, threads, [items, &body](std::ptrdiff_t i) { body(items[i]); });
  }
  /// Σ term(i).
  template <class Term>
  double sum(std::ptrdiff_t count, Term term) const {
    return add_up(join_blocks(count, term, [](double sum, double of_item) { return sum + of_item; }));
  }
  /// Largest of term(i) ≥ 0; 0 where there are no items.
  template <class Term>
  double find_largest(std::ptrdiff_t count, Term term) const {
    double largest = 0.0;
    for (const double of_block : join_blocks(count, term, [](double a, double b) { return std::max(a, b); }))
      largest = std::max(largest, of_block);
    return largest;
  }

 private:
  static constexpr std::ptrdiff_t kLength = 64;

  static constexpr std::ptrdiff_t count_blocks(std::ptrdiff_t items) {
    return (items + kLength - 1) / kLength;
  }
  template <class Term, class Join>
  const std::vector<double>& join_blocks(std::ptrdiff_t count, Term term, Join join) const {
    prepare(count);
    const std::ptrdiff_t items = size(count);
    return find_of_blocks(count_blocks(items), [&](std::ptrdiff_t block) {
      double of_block = 0.0;
      for (std::ptrdiff_t i = block * kLength; i < std::min((block + 1) * kLength, items); ++i)
        of_block = join(of_block, term(at(i)));
      return of_block;
    });
  }

  std::ptrdiff_t m_least_shared;
};

/// In runs of fixed length: items 0 … count−1, or those of a list of runs. A block is a run.
class OrderedRuns : public RestrictedLoop {
 public:
  static constexpr std::ptrdiff_t kLength = 8;

  explicit OrderedRuns(int threads) : RestrictedLoop(threads) {}

  /// Takes the memory for sums of so many items, whichever runs are in the list.
  void prepare(std::ptrdiff_t count) const {
    m_of_block.reserve(static_cast<std::size_t>(count_all_runs(count)));
  }
  /// body(begin, end) for every run; its number is added to the sum that is returned.
  template <class Body>
  double sum(std::ptrdiff_t count, Body body) const {
    prepare(count);
    return add_up(find_of_blocks(count_runs(count), [&](std::ptrdiff_t i) {
      const std::ptrdiff_t run = at(i);
      return static_cast<double>(body(run * kLength, std::min((run + 1) * kLength, count)));
    }));
  }
  template <class Body>
  void each(std::ptrdiff_t count, Body body) const {
    each_run(count, [&body](std::ptrdiff_t, std::ptrdiff_t begin, std::ptrdiff_t end) { body(begin, end); });
  }
  /// body(i, begin, end) for the i-th of the runs.
  template <class Body>
  void each_run(std::ptrdiff_t count, Body body) const {
    const std::vector<int>* list = m_list;
    parallel_for(count_runs(count), m_threads, [list, count, &body](std::ptrdiff_t i) {
      const std::ptrdiff_t run = list ? (*list)[static_cast<std::size_t>(i)] : i;
      body(i, run * kLength, std::min((run + 1) * kLength, count));
    });
  }
  /// As each, one run after the other by the calling thread.
  template <class Body>
  void each_in_order(std::ptrdiff_t count, Body body) const {
    for (std::ptrdiff_t i = 0; i < count_runs(count); ++i) {
      const std::ptrdiff_t run = at(i);
      body(run * kLength, std::min((run + 1) * kLength, count));
    }
  }
  /// Of items 0 … count−1, those in the list.
  std::ptrdiff_t count_runs(std::ptrdiff_t count) const { return size(count_all_runs(count)); }
  static constexpr std::ptrdiff_t count_all_runs(std::ptrdiff_t count) {
    return (count + kLength - 1) / kLength;
  }
};

}  // namespace argil
