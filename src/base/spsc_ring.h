#pragma once

#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

namespace argil {

/// Queue from one thread to another. Neither waits: what does not fit is refused. The places are allocated
/// once; nothing else is, where T moves without allocating.
template <class T>
class SpscRing {
 public:
  explicit SpscRing(std::size_t capacity) : m_places(capacity + 1) {}

  /// The writing thread. Is there a place? Then there is one until it is filled.
  bool has_room() const {
    const std::size_t end = m_end.load(std::memory_order_relaxed);
    return (end + 1 == m_places.size() ? 0 : end + 1) != m_begin.load(std::memory_order_acquire);
  }
  /// The writing thread. False when the ring is full; `value` is as it was then.
  bool push(T&& value) {
    if (!has_room()) return false;
    const std::size_t end = m_end.load(std::memory_order_relaxed);
    m_places[end] = std::move(value);
    m_end.store(end + 1 == m_places.size() ? 0 : end + 1, std::memory_order_release);
    return true;
  }
  /// The reading thread. False when there is nothing.
  bool pop(T& value) {
    const std::size_t begin = m_begin.load(std::memory_order_relaxed);
    if (begin == m_end.load(std::memory_order_acquire)) return false;
    value = std::move(m_places[begin]);
    m_begin.store(begin + 1 == m_places.size() ? 0 : begin + 1, std::memory_order_release);
    return true;
  }

 private:
  static constexpr std::size_t kCacheLine = 64;  // so that the two sides' counters do not share one
  std::vector<T> m_places;
  alignas(kCacheLine) std::atomic<std::size_t> m_end = 0;
  alignas(kCacheLine) std::atomic<std::size_t> m_begin = 0;
};

}  // namespace argil
