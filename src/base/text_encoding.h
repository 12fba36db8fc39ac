#pragma once

#include <string>

namespace argil {

/// A file's bytes as UTF-8 without a byte order mark: UTF-16 that begins with one (what "Unicode text" is on
/// Windows) is put into UTF-8. Bytes that are no text, as they hold a zero or half a character, stay as they
/// are: a binary file may begin with any bytes.
std::string to_utf8(std::string bytes);

}  // namespace argil
