#pragma once

#include <algorithm>
#include <cstddef>

namespace argil {

/// Σ term(i), i = 0 … count−1, in blocks of a fixed length whose partial sums are added in order, so that
/// the bits depend on `count` alone and never on how many threads work beside it.
template <class Term>
double ordered_sum(std::ptrdiff_t count, Term term) {
  constexpr std::ptrdiff_t kBlock = 256;
  double total = 0.0;
  for (std::ptrdiff_t begin = 0; begin < count; begin += kBlock) {
    const std::ptrdiff_t end = std::min(count, begin + kBlock);
    double partial = 0.0;
    for (std::ptrdiff_t i = begin; i < end; ++i) partial += term(i);
    total += partial;
  }
  return total;
}

}  // namespace argil
