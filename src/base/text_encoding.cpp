#include "base/text_encoding.h"

#include <algorithm>
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

/// Bytes of the first character of `text` in UTF-8; 0 where it begins with a control or with no character.
std::size_t find_printable(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80) return byte(0) >= ' ' && byte(0) != 0x7F ? 1 : 0;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  return byte(0) == 0xC2 && byte(1) < 0xA0 ? 0 : length;
}

}  // namespace

std::string to_utf8(std::string bytes) {
  const bool is_big = bytes.starts_with("\xFE\xFF");
  if (is_big || bytes.starts_with("\xFF\xFE")) return read_utf16(bytes, is_big).value_or(bytes);
  if (bytes.starts_with("\xEF\xBB\xBF") && bytes.find('\0') == std::string::npos) bytes.erase(0, 3);
  return bytes;
}

bool looks_like_utf16(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) bytes.remove_prefix(2);
  constexpr std::size_t kHead = 64;
  if (bytes.size() < 4) return false;
  const std::size_t zero = bytes[0] == '\0' ? 0 : 1;  // which byte of two
  for (std::size_t i = 0; i < std::min(bytes.size(), kHead); ++i)
    if ((bytes[i] == '\0') != (i % 2 == zero)) return false;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
    if (bytes[i] == '\0' && bytes[i + 1] == '\0') return false;
  return true;
}

std::string to_line_feeds(std::string bytes) {
  if (bytes.find('\n') == std::string::npos && bytes.find('\0') == std::string::npos)
    std::replace(bytes.begin(), bytes.end(), '\r', '\n');
  return bytes;
}

std::string to_printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = find_printable(text);
    shown += length == 0 ? "?" : text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

}  // namespace argil
