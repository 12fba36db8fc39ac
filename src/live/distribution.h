#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace argil::live {

/// Counts of values ≥ 0 in bins of equal width, for quantiles of any number of them; the largest is exact.
class Distribution {
 public:
  explicit Distribution(double width, std::size_t bins = 100000) : m_width(width), m_count(bins, 0) {}

  void add(double value) {
    const double bin = std::clamp(std::floor(value / m_width), 0.0, static_cast<double>(m_count.size() - 1));
    ++m_count[static_cast<std::size_t>(bin)];
    ++m_total;
    m_largest = std::max(m_largest, value);
  }
  /// Upper end of the bin below which the share p of the values lies; no larger than the largest.
  double quantile(double p) const {
    const auto wanted = static_cast<std::int64_t>(std::ceil(p * static_cast<double>(m_total)));
    std::int64_t below = 0;
    for (std::size_t i = 0; i < m_count.size(); ++i) {
      below += m_count[i];
      if (below >= wanted && below > 0) return std::min(m_largest, static_cast<double>(i + 1) * m_width);
    }
    return m_largest;
  }
  double largest() const { return m_largest; }
  std::int64_t total() const { return m_total; }

 private:
  double m_width;
  std::vector<std::int64_t> m_count;
  std::int64_t m_total = 0;
  double m_largest = 0.0;
};

}  // namespace argil::live
