#pragma once

#include <string>
#include <string_view>

namespace argil {

/// A file's bytes as UTF-8 without a byte order mark: UTF-16 that begins with one (what "Unicode text" is on
/// Windows) is put into UTF-8. Bytes that are no text, as they hold a zero or half a character, stay as they
/// are: a binary file may begin with any bytes.
std::string to_utf8(std::string bytes);

/// Is it text in UTF-16 that `to_utf8` left as it is, as it has no byte order mark or ends within a
/// character? Latin letters make every second byte zero; binary numbers soon have two zeros side by side.
bool looks_like_utf16(std::string_view bytes);

/// A text whose lines end with carriage returns only (as on old Macs) with line feeds instead. Bytes that
/// hold a line feed or a zero stay as they are.
std::string to_line_feeds(std::string bytes);

/// `text` as a message may show it: controls and bytes that are not UTF-8 become question marks.
std::string to_printable(std::string_view text);

}  // namespace argil
