#pragma once

#include <cstdint>
#include <string_view>

namespace argil {

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every machine for a seed and a stream name.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::string_view stream = {}) : m_state(seed) {
    for (const char c : stream) m_state = (m_state ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  std::uint64_t next_bits() {
    std::uint64_t z = (m_state += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1), 53 random bits.
  double uniform() { return static_cast<double>(next_bits() >> 11) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t m_state;
};

}  // namespace argil
