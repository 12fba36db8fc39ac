#pragma once

// Text fields of one record of a table (RFC 4180, without line breaks inside quotes; comma, semicolon, tab or
// blanks between fields) and numbers without a locale.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace argil::device::internal {

/// `text` without blanks and tabs at both ends.
std::string_view trim(std::string_view text);

/// Fields of one record into `fields` (its storage is reused), trimmed, quotes taken off. `separator` is ',',
/// ';', '\t', or ' ' for any number of blanks and tabs. False when a quote is not closed or is followed by
/// more text.
bool split_record(std::string_view record, char separator, std::vector<std::string>& fields);

/// What separates the fields of a table, by its first row (names, or already a sample) and its second (may be
/// empty). Both must have as many fields; among those, what gives the second row most numbers.
char find_separator(std::string_view first, std::string_view second);

/// "comma", "semicolon", "tab" or "blanks".
std::string_view name_separator(char separator);

/// The number that the whole text spells ("nan" and "inf" included); nothing for any other text.
std::optional<double> find_number(std::string_view text);

/// The same with one comma in the place of the point: "0,125". Nothing for any other text.
std::optional<double> find_comma_number(std::string_view text);

/// Does a cell say that there is no number: "nan", "NA", "null", in any case?
bool is_lost(std::string_view text);

/// "'text'" for messages, cut where it is long.
std::string quote(std::string_view text);
/// "a, b" for messages, cut with the number of the others where it is long.
std::string join(const std::vector<std::string>& words);

/// Lines of a text one after the other; "\n", "\r\n" and "\r" end a line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : m_text(text) {}
  bool next(std::string_view& line);
  std::size_t line_number() const { return m_number; }  ///< of the last line given, from 1
  std::size_t line_offset() const { return m_begin; }   ///< byte where the last line given begins
 private:
  std::string_view m_text;
  std::size_t m_begin = 0;
  std::size_t m_next = 0;
  std::size_t m_number = 0;
};

}  // namespace argil::device::internal
