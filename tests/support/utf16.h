#pragma once

#include <string>
#include <string_view>

namespace argil::test {

/// `ascii` in UTF-16 without a byte order mark; the high byte of each unit first when `is_big`.
inline std::string to_utf16(std::string_view ascii, bool is_big) {
  std::string wide;
  for (const char c : ascii) {
    if (is_big) wide += '\0';
    wide += c;
    if (!is_big) wide += '\0';
  }
  return wide;
}

}  // namespace argil::test
