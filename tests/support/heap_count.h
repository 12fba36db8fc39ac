#pragma once

// Counts what a program takes from the heap, by operator new and by Eigen's own route (malloc), which glibc
// lets a program replace. Included by one file of a program. Sanitizers replace malloc themselves:
// ARGIL_COUNTS_HEAP is not defined there, and such tests are left out.

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <atomic>
#include <cstddef>

namespace argil::test {

inline std::atomic<std::size_t> s_allocations = 0;
inline thread_local std::size_t t_allocations = 0;
inline std::atomic<std::size_t> s_bytes = 0;

/// Calls of malloc since the program's start, by any thread.
inline std::size_t count_allocations() {
  return s_allocations;
}

/// What these calls asked for, whether or not it was given back.
inline std::size_t count_bytes() {
  return s_bytes;
}

/// By the calling thread alone.
inline std::size_t count_allocations_of_thread() {
  return t_allocations;
}

}  // namespace argil::test

extern "C" void* __libc_malloc(std::size_t size);     // NOLINT: glibc's name
extern "C" void* malloc(std::size_t size) noexcept {  // NOLINT
  argil::test::s_allocations.fetch_add(1, std::memory_order_relaxed);
  ++argil::test::t_allocations;
  argil::test::s_bytes.fetch_add(size, std::memory_order_relaxed);
  return __libc_malloc(size);
}
#define ARGIL_COUNTS_HEAP

#endif
