#pragma once

#include <array>
#include <atomic>

namespace argil {

/// The newest value from one thread to another, neither of which ever waits: three places, of which each side
/// owns one and swaps it for the third. What is put twice before it is taken is overwritten. T is copied; it
/// should not allocate.
template <class T>
class LatestValue {
 public:
  /// The writing thread.
  void put(const T& value) {
    m_places[m_writing] = value;
    m_writing = m_third.exchange(m_writing | kNew, std::memory_order_acq_rel) & ~kNew;
  }
  /// The reading thread. Writes `value` and says true when something was put since the last take.
  bool take(T& value) {
    if ((m_third.load(std::memory_order_relaxed) & kNew) == 0) return false;
    m_reading = m_third.exchange(m_reading, std::memory_order_acq_rel) & ~kNew;
    value = m_places[m_reading];
    return true;
  }

 private:
  static constexpr unsigned kNew = 4;
  std::array<T, 3> m_places{};
  unsigned m_writing = 0;
  std::atomic<unsigned> m_third = 1;
  unsigned m_reading = 2;
};

}  // namespace argil
