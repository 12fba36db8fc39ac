#include "base/text_encoding.h"

#include <cstdint>
#include <optional>

namespace argil {
namespace {

void append_utf8(std::uint32_t code, std::string& out) {
  const auto put = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
  }
  put(0x80 | (code & 0x3F));
}

/// Nothing where it is no text.
std::optional<std::string> read_utf16(const std::string& bytes, bool is_big) {
  if (bytes.size() % 2 != 0) return std::nullopt;
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<std::uint8_t>(bytes[at]);
    const auto second = static_cast<std::uint8_t>(bytes[at + 1]);
    return static_cast<std::uint32_t>(is_big ? first << 8 | second : second << 8 | first);
  };
  const auto is_half = [](std::uint32_t u, std::uint32_t begin) { return u >= begin && u < begin + 0x400; };
  std::string text;
  for (std::size_t i = 2; i < bytes.size(); i += 2) {  // after the mark
    const std::uint32_t high = unit(i);
    if (high == 0 || is_half(high, 0xDC00)) return std::nullopt;
    if (!is_half(high, 0xD800)) {
      append_utf8(high, text);
      continue;
    }
    i += 2;
    if (i >= bytes.size() || !is_half(unit(i), 0xDC00)) return std::nullopt;
    append_utf8(0x10000 + ((high - 0xD800) << 10) + (unit(i) - 0xDC00), text);
  }
  return text;
}

}  // namespace

std::string to_utf8(std::string bytes) {
  const bool is_big = bytes.starts_with("\xFE\xFF");
  if (is_big || bytes.starts_with("\xFF\xFE")) return read_utf16(bytes, is_big).value_or(bytes);
  if (bytes.starts_with("\xEF\xBB\xBF") && bytes.find('\0') == std::string::npos) bytes.erase(0, 3);
  return bytes;
}

}  // namespace argil
