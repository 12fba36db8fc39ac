#pragma once

#include <cmath>
#include <cstddef>

// A function that stands before this is compiled for each kind of processor and chosen when the program
// starts. Contraction into fused operations is off, so all versions give the same bits. What such a function
// calls must be inlined into it (ARGIL_INLINE), or it runs in the version for the oldest processor.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ARGIL_EVERY_PROCESSOR __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ARGIL_EVERY_PROCESSOR
#endif
#define ARGIL_INLINE inline __attribute__((always_inline))

namespace argil {

/// Numbers that go through the same operations side by side; the bits of each depend on itself alone. A
/// formula that is a template of `Real` runs on double and on Lanes alike; `mask ? a : b` chooses in each.
/// None is returned by value: how that is done depends on the processor.
inline constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using LaneMask = decltype(Lanes{} < Lanes{});
template <class Real>
using MaskOf = decltype(Real{} < Real{});

ARGIL_INLINE bool any(bool mask) {
  return mask;
}
ARGIL_INLINE bool any(const LaneMask& mask) {
  bool found = false;
  for (int i = 0; i < kLanes; ++i) found |= mask[i] != 0;
  return found;
}

ARGIL_INLINE void set_root(double& root, double a) {
  root = std::sqrt(a);
}
ARGIL_INLINE void set_root(Lanes& root, const Lanes& a) {
  for (int i = 0; i < kLanes; ++i) root[i] = __builtin_sqrt(a[i]);
}

/// 3×3, column by column.
template <class Real>
struct Real33 {
  Real m[9];
};

}  // namespace argil
