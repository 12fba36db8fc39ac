#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/parallel.h"

namespace argil {

/// Items 0 … count−1, or those of a list, in blocks of fixed length, which threads share. A sum is that of
/// the blocks' sums, added in order, so that no bits depend on the number of threads. No allocation after the
/// first call of one size.
class OrderedItems {
 public:
  explicit OrderedItems(int threads) : m_threads(threads) {}

  /// Takes the memory for sums over so many items, whichever are visited.
  void prepare(std::ptrdiff_t count) const { m_of_block.reserve(count_blocks(count)); }
  /// body(i) for every item.
  template <class Body>
  void each(std::ptrdiff_t count, Body body) const {
    parallel_for(count_visited(count), m_threads, [&](std::ptrdiff_t i) { body(item(i)); });
  }
  /// Σ term(i).
  template <class Term>
  double sum(std::ptrdiff_t count, Term term) const {
    find_of_blocks(count, term, [](double sum, double of_item) { return sum + of_item; });
    double total = 0.0;
    for (const double of_block : m_of_block) total += of_block;
    return total;
  }
  /// Largest of term(i) ≥ 0; 0 where there are no items.
  template <class Term>
  double find_largest(std::ptrdiff_t count, Term term) const {
    find_of_blocks(count, term, [](double largest, double of_item) { return std::max(largest, of_item); });
    double largest = 0.0;
    for (const double of_block : m_of_block) largest = std::max(largest, of_block);
    return largest;
  }
  /// From now on only these items, increasing; the list must outlive them. Null: all.
  void visit(const std::vector<int>* items) { m_visited = items; }
  const std::vector<int>* visited() const { return m_visited; }

 private:
  static constexpr std::ptrdiff_t kLength = 64;

  static constexpr std::size_t count_blocks(std::ptrdiff_t items) {
    return static_cast<std::size_t>((items + kLength - 1) / kLength);
  }
  std::ptrdiff_t count_visited(std::ptrdiff_t count) const {
    return m_visited ? static_cast<std::ptrdiff_t>(m_visited->size()) : count;
  }
  std::ptrdiff_t item(std::ptrdiff_t i) const {
    return m_visited ? (*m_visited)[static_cast<std::size_t>(i)] : i;
  }
  template <class Body>
  void each_block(std::ptrdiff_t count, Body body) const {
    const std::ptrdiff_t visited = count_visited(count);
    parallel_for((visited + kLength - 1) / kLength, m_threads, [&](std::ptrdiff_t block) {
      body(block, block * kLength, std::min((block + 1) * kLength, visited));
    });
  }
  template <class Term, class Join>
  void find_of_blocks(std::ptrdiff_t count, Term term, Join join) const {
    prepare(count);
    m_of_block.resize(count_blocks(count_visited(count)));
    each_block(count, [&](std::ptrdiff_t block, std::ptrdiff_t begin, std::ptrdiff_t end) {
      double of_block = 0.0;
      for (std::ptrdiff_t i = begin; i < end; ++i) of_block = join(of_block, term(item(i)));
      m_of_block[static_cast<std::size_t>(block)] = of_block;
    });
  }

  int m_threads;
  const std::vector<int>* m_visited = nullptr;
  mutable std::vector<double> m_of_block;
};

}  // namespace argil
