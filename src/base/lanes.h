#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

// A function that stands before this is compiled for each kind of processor and chosen when the program
// starts. Contraction into fused operations is off, so all versions give the same bits. What such a function
// calls must be inlined into it (ARGIL_INLINE), or it runs in the version for the oldest processor.
// Not with Clang: version 14 takes the first version, whatever the processor, where the call is in another
// file than the function.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ARGIL_EVERY_PROCESSOR __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ARGIL_EVERY_PROCESSOR
#endif
// Of functions that such a one calls: GCC leaves the upper halves of vectors as they are where it sees that
// the callee does not touch them, and all code after it is slow.
#if defined(__GNUC__) && !defined(__clang__)
#define ARGIL_CALLED_FROM_EVERY __attribute__((noipa))
#else
#define ARGIL_CALLED_FROM_EVERY __attribute__((noinline))
#endif
#define ARGIL_INLINE inline __attribute__((always_inline))

namespace argil {

/// Numbers that go through the same operations side by side; the bits of each depend on itself alone. A
/// formula that is a template of `Real` runs on double and on Lanes alike; `mask ? a : b` chooses in each.
/// None is returned by value: how that is done depends on the processor.
inline constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
/// Three numbers of a 3-vector; the fourth is whatever follows.
using Quad = double __attribute__((vector_size(32)));

/// The numbers from any address on, and all of them to any address. Through memcpy: Clang forgets a vector
/// type's alignment where a reference to it is returned.
ARGIL_INLINE void read(const double* from, Lanes& to) {
  std::memcpy(&to, from, sizeof to);
}
ARGIL_INLINE void read(const double* from, Quad& to) {
  std::memcpy(&to, from, sizeof to);
}
ARGIL_INLINE void write(const Lanes& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}
ARGIL_INLINE void write(const Quad& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}

/// Turns eight rows of eight numbers into eight columns.
ARGIL_INLINE void transpose(Lanes (&a)[kLanes]) {
  static_assert(kLanes == 8);
  Lanes b[8], c[8];
  for (int i = 0; i < 8; i += 2) {
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; i += 4)
    for (int k = i; k < i + 2; ++k) {
      c[k] = __builtin_shufflevector(b[k], b[k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      c[k + 2] = __builtin_shufflevector(b[k], b[k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int k = 0; k < 4; ++k) {
    a[k] = __builtin_shufflevector(c[k], c[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    a[k + 4] = __builtin_shufflevector(c[k], c[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// Is any of them other than zero?
ARGIL_INLINE bool any(double mask) {
  return mask != 0.0;
}
ARGIL_INLINE bool any(const Lanes& mask) {
  using Bits = long long __attribute__((vector_size(sizeof(Lanes))));
  using Half = long long __attribute__((vector_size(sizeof(Lanes) / 2)));
  const Bits bits = reinterpret_cast<const Bits&>(mask);  // a mask has no −0
  const Half half =
      __builtin_shufflevector(bits, bits, 0, 1, 2, 3) | __builtin_shufflevector(bits, bits, 4, 5, 6, 7);
  return (half[0] | half[1] | half[2] | half[3]) != 0;
}

ARGIL_INLINE void set_root(double& root, double a) {
  root = std::sqrt(a);
}
ARGIL_INLINE void set_root(Lanes& root, const Lanes& a) {
  for (int i = 0; i < kLanes; ++i) root[i] = __builtin_sqrt(a[i]);
}

/// The first eight of `Count` numbers of each of the items begin … last; the last one fills the lanes that
/// are left over.
template <int Count>
ARGIL_INLINE void read_eight(const double* from, std::ptrdiff_t begin, std::ptrdiff_t last,
                             Lanes (&rows)[8]) {
#pragma GCC unroll 8
  for (int lane = 0; lane < kLanes; ++lane) read(from + Count * std::min(begin + lane, last), rows[lane]);
  transpose(rows);
}

/// Reads `Count` numbers of each of the items begin … last; the last one fills the lanes that are left over.
template <int Count>
ARGIL_INLINE void read_lanes(const double* from, std::ptrdiff_t begin, std::ptrdiff_t last, Lanes* to) {
  constexpr int kEights = Count / kLanes * kLanes;
  Lanes rows[8];
  if constexpr (Count >= kLanes) {
    read_eight<Count>(from, begin, last, rows);
    for (int k = 0; k < kLanes; ++k) to[k] = rows[k];
  }
  if constexpr (Count > kLanes + 2) {  // the last eight of them, some of which are known
    read_eight<Count>(from + Count - kLanes, begin, last, rows);
    for (int k = kEights; k < Count; ++k) to[k] = rows[k - Count + kLanes];
  } else if constexpr (Count == 6) {
    // Eight are read that end with the item's six; of the first item, eight that begin with them.
    if (begin < last) {
      Lanes first;
      read(from + Count * begin, first);
      rows[0] = __builtin_shufflevector(first, first, 6, 7, 0, 1, 2, 3, 4, 5);
      for (int lane = 1; lane < kLanes; ++lane)
        read(from + Count * std::min(begin + lane, last) - 2, rows[lane]);
      transpose(rows);
      for (int k = 0; k < Count; ++k) to[k] = rows[k + 2];
      return;
    }
  }
  if constexpr (Count <= kLanes + 2)
    for (int lane = 0; lane < kLanes; ++lane) {
      const double* item = from + Count * std::min(begin + lane, last);
      for (int k = kEights; k < Count; ++k) to[k][lane] = item[k];
    }
}

/// Turns `from` into rows and stores the first `Width` numbers of each at `to`, `stride` apart.
template <int Width>
ARGIL_INLINE void write_rows(const Lanes (&from)[8], std::ptrdiff_t stride, double* to) {
  static_assert(Width == kLanes || Width == 6);
  Lanes rows[8] = {from[0], from[1], from[2], from[3], from[4], from[5], from[6], from[7]};
  transpose(rows);
#pragma GCC unroll 8
  for (int lane = 0; lane < kLanes; ++lane) {
    double* row = to + stride * lane;
    if constexpr (Width == kLanes) {
      write(rows[lane], row);
    } else {
      const Quad first = __builtin_shufflevector(rows[lane], rows[lane], 0, 1, 2, 3);
      write(first, row);
      row[4] = rows[lane][4];
      row[5] = rows[lane][5];
    }
  }
}

/// Writes `Count` numbers of each of the items begin … end−1, at most kLanes of them, and nothing beside.
template <int Count>
ARGIL_INLINE void write_lanes(const Lanes* from, std::ptrdiff_t begin, std::ptrdiff_t end, double* to) {
  double* first = to + Count * begin;
  if (Count > 2 && end - begin == kLanes) {
    Lanes eight[8];
    for (int k = 0; k < kLanes; ++k) eight[k] = from[k < Count ? k : 0];
    write_rows<Count == 6 ? 6 : kLanes>(eight, Count, first);
    if constexpr (Count > kLanes + 2) {  // the last eight, some of them again
      for (int k = 0; k < kLanes; ++k) eight[k] = from[Count - kLanes + k];
      write_rows<kLanes>(eight, Count, first + Count - kLanes);
    } else if constexpr (Count > kLanes) {
      for (int lane = 0; lane < kLanes; ++lane)
        for (int k = kLanes; k < Count; ++k) first[Count * lane + k] = from[k][lane];
    }
    return;
  }
  for (int lane = 0; lane < static_cast<int>(end - begin); ++lane)
    for (int k = 0; k < Count; ++k) first[Count * lane + k] = from[k][lane];
}

/// 3×3, column by column.
template <class Real>
struct Real33 {
  Real m[9];
};

}  // namespace argil
