#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace argil {

/// SHA-256 (FIPS 180-4) of a growing sequence of bytes.
class Sha256 {
 public:
  enum class Code {
    fastest,   ///< with the processor's own instructions, where it has them
    portable,  ///< the same digest
  };
  explicit Sha256(Code code = Code::fastest);
  Sha256& add(std::span<const std::byte> bytes);
  Sha256& add(const std::string& text);
  /// Adds `count` doubles by their bits, so that −0 and 0 differ.
  Sha256& add(const double* values, std::size_t count);
  /// Digest of what was added, as 64 hexadecimal digits. Leaves the object as it was.
  std::string hex_digest() const;

 private:
  using Compress = void (*)(std::uint32_t* state, const std::uint8_t* blocks, std::size_t count);
  Compress m_compress;
  std::array<std::uint32_t, 8> m_state;
  std::array<std::uint8_t, 64> m_buffer;
  std::uint64_t m_length = 0;  // bytes added
};

}  // namespace argil
