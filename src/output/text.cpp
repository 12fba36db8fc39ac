#include "output/text.h"

#include <cerrno>
#include <cstring>
#include <fstream>

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

void write_file(const std::string& file, const std::string& content) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << content;
  stream.close();
  if (!stream)
    throw IoError(file, std::string("cannot be written: ") + std::strerror(errno != 0 ? errno : EIO));
}

}  // namespace argil::output
