#pragma once

#include <string>
#include <string_view>

namespace argil {

/// A to Z in small letters, whatever the locale; all else as it is.
inline std::string to_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace argil
