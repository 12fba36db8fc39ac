#include "mesh_files/file_cursor.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/read_file.h"
#include "base/text_encoding.h"

namespace argil::mesh_files {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";
constexpr std::size_t kQuotedLength = 40;  // longer words are cut in messages

constexpr bool is_blank(char c) {
  return kBlanks.find(c) != std::string_view::npos;
}

// A word as a message shows it: cut, and without bytes that would spoil a terminal.
std::string quote(std::string_view word) {
  std::string text(word.substr(0, kQuotedLength));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return "\"" + text + (word.size() > kQuotedLength ? "…\"" : "\"");
}

// std::from_chars knows no plus sign. "+-1" stays as it is, which is no number.
std::string_view drop_plus(std::string_view word) {
  const bool is_positive = word.starts_with('+') && !word.starts_with("+-");
  return is_positive ? word.substr(1) : word;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

FileCursor::FileCursor(const std::string& file) : m_file(file), m_bytes(to_utf8(read_file(file))) {}

void FileCursor::seek(std::size_t offset) {
  m_offset = m_last = std::min(offset, m_bytes.size());
}

void FileCursor::skip_blanks() {
  while (m_offset < m_bytes.size()) {
    if (m_comment_mark != '\0' && m_bytes[m_offset] == m_comment_mark) {
      m_offset = std::min(m_bytes.find('\n', m_offset), m_bytes.size());
    } else if (is_blank(m_bytes[m_offset])) {
      ++m_offset;
    } else {
      break;
    }
  }
}

std::optional<std::string_view> FileCursor::find_word() {
  skip_blanks();
  m_last = m_offset;
  while (m_offset < m_bytes.size() && !is_blank(m_bytes[m_offset])) ++m_offset;
  if (m_offset == m_last) return std::nullopt;
  return bytes().substr(m_last, m_offset - m_last);
}

std::optional<std::string_view> FileCursor::peek_word() {
  const std::size_t offset = m_offset;
  const std::size_t last = m_last;
  const std::optional<std::string_view> word = find_word();
  m_offset = offset;
  m_last = last;
  return word;
}

std::string_view FileCursor::word(std::string_view what) {
  const std::optional<std::string_view> word = find_word();
  if (!word) fail_truncated(what);
  return *word;
}

void FileCursor::expect_word(std::string_view expected) {
  const std::string_view found = word(expected);
  if (found != expected)
    fail(quote(found) + " where " + std::string(expected) + " was expected",
         "check the counts above this place, or write the file again");
}

double FileCursor::number(std::string_view what) {
  return parse_number(word(what), what);
}

std::int64_t FileCursor::integer(std::string_view what) {
  return parse_integer(word(what), what);
}

std::int64_t FileCursor::count(std::string_view what, std::size_t bytes_each) {
  const std::int64_t count = integer(what);
  require_room(count, bytes_each, what);
  return count;
}

std::optional<std::string_view> FileCursor::find_line() {
  m_last = m_offset;
  if (m_offset >= m_bytes.size()) return std::nullopt;
  const std::size_t end = std::min(m_bytes.find('\n', m_offset), m_bytes.size());
  m_offset = std::min(end + 1, m_bytes.size());
  return trim(bytes().substr(m_last, end - m_last));
}

std::string_view FileCursor::take(std::size_t size, std::string_view what) {
  m_last = m_offset;
  if (size > remaining()) fail_truncated(what);
  m_offset += size;
  return bytes().substr(m_last, size);
}

double FileCursor::binary_number(std::string_view what) {
  const double value = binary<double>(what);
  if (!std::isfinite(value)) fail(std::string(what) + " is not finite", "give a finite number");
  return value;
}

void FileCursor::require_room(std::int64_t count, std::size_t bytes_each, std::string_view what) const {
  if (count < 0) fail(std::string(what) + " is " + std::to_string(count), "a count is 0 or more");
  if (static_cast<std::uint64_t>(count) > remaining() / bytes_each)
    fail(std::string(what) + " is " + std::to_string(count) + ", more than the " +
             std::to_string(remaining()) + " bytes left of the file can hold",
         "the file is truncated or the count is wrong; write it again");
}

void FileCursor::fail(std::string_view problem, std::string_view remedy) const {
  fail_at(m_last, problem, remedy);
}

void FileCursor::fail_at(std::size_t offset, std::string_view problem, std::string_view remedy) const {
  throw InputError(m_file, place(offset), problem, remedy);
}

void FileCursor::fail_truncated(std::string_view what) const {
  fail_at(m_bytes.size(), "the file ends where " + std::string(what) + " was expected",
          "it is truncated; write or copy it again");
}

double FileCursor::parse_number(std::string_view word, std::string_view what) const {
  const std::string_view digits = drop_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_whole_word = end == digits.data() + digits.size();
  if (error == std::errc::result_out_of_range && is_whole_word)
    fail(std::string(what) + " is " + quote(word) + ", outside the range of double precision",
         "give a number between 1e-307 and 1e308 in magnitude, or 0");
  if (error != std::errc() || !is_whole_word)
    fail(std::string(what) + " is " + quote(word) + ", not a number", "give a decimal number such as 0.25");
  if (!std::isfinite(value)) fail(std::string(what) + " is " + quote(word), "give a finite number");
  return value;
}

std::int64_t FileCursor::parse_integer(std::string_view word, std::string_view what) const {
  const std::string_view digits = drop_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(std::string(what) + " is " + quote(word) + ", not a whole number of 64 bits", "give a whole number");
  return value;
}

std::string FileCursor::place(std::size_t offset) const {
  if (m_is_binary) return "byte " + std::to_string(offset);
  // The end of a file that ends with a line break is its last line, not the empty one after it.
  if (offset == m_bytes.size() && m_bytes.ends_with('\n')) --offset;
  const auto end = m_bytes.begin() + static_cast<std::ptrdiff_t>(offset);
  return "line " + std::to_string(1 + std::count(m_bytes.begin(), end, '\n'));
}

std::string_view WordsOf::next() {
  m_rest = trim(m_rest);
  std::size_t size = 0;
  while (size < m_rest.size() && !is_blank(m_rest[size])) ++size;
  const std::string_view word = m_rest.substr(0, size);
  m_rest.remove_prefix(size);
  return word;
}

}  // namespace argil::mesh_files
