#include "output/text.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace argil::output {

std::string escape_xml(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string rounded(double value) {
  constexpr int kDigits = 4;
  std::ostringstream out;
  out.precision(kDigits);
  out << value;
  return out.str();
}

std::string with_prefix(double value, const std::string& unit) {
  constexpr std::array kPrefixes = {"p", "n", "µ", "m", "", "k", "M", "G"};
  constexpr int kNone = 4;   // where there is no prefix
  constexpr int kEvery = 3;  // decimal places from one to the next
  if (value == 0.0 || !std::isfinite(value)) return rounded(value) + ' ' + unit;
  // Of the digits that are printed: 999.96 becomes 1 of the next prefix.
  const double printed = std::stod(rounded(value));
  const int places = static_cast<int>(std::floor(std::log10(std::abs(printed)) / kEvery));
  if (places < -kNone) return rounded(value) + ' ' + unit;
  const int step = std::min(places, static_cast<int>(kPrefixes.size()) - 1 - kNone);
  return rounded(value / std::pow(10.0, kEvery * step)) + ' ' +
         kPrefixes[static_cast<std::size_t>(kNone + step)] + unit;
}

void write_file(const std::string& file, const std::string& content) {
  write_file(file, [&](std::ostream& out) { out << content; });
}

void write_file(const std::string& file, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  try {
    std::ofstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);  // at once, while errno is that of the failure
    stream.open(file, std::ios::binary | std::ios::trunc);
    write(stream);
    stream.close();
  } catch (const std::ios_base::failure&) {
    throw IoError(file, std::string("cannot be written: ") + std::strerror(errno != 0 ? errno : EIO));
  }
}

}  // namespace argil::output
