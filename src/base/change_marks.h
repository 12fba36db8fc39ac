#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace argil {

/// Which of some items have changed since the last commit, so that what each was before can be kept. Threads
/// may set different items at once.
class ChangeMarks {
 public:
  void resize(std::size_t count) { m_epoch.resize(count, 0); }
  std::size_t size() const { return m_epoch.size(); }
  bool is_set(std::size_t i) const { return m_epoch[i] == m_now; }
  /// True the first time since the last clear().
  bool set(std::size_t i) {
    if (is_set(i)) return false;
    m_epoch[i] = m_now;
    return true;
  }
  /// None has changed. Does not look at them.
  void clear() {
    if (++m_now != 0) return;
    std::fill(m_epoch.begin(), m_epoch.end(), 0);
    m_now = 1;
  }

 private:
  std::vector<std::uint32_t> m_epoch;  // in which each was set
  std::uint32_t m_now = 1;
};

}  // namespace argil
