#include "mesh_files/file_cursor.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/lower_case.h"
#include "base/read_file.h"
#include "base/text_encoding.h"

namespace argil::mesh_files {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";
constexpr std::size_t kQuotedLength = 40;  // longer words are cut in messages

constexpr bool is_blank(char c) {
  return kBlanks.find(c) != std::string_view::npos;
}

// A word as a message shows it.
std::string quote(std::string_view word) {
  return "\"" + std::string(word.substr(0, kQuotedLength)) + (word.size() > kQuotedLength ? "…\"" : "\"");
}

// std::from_chars knows no plus sign. "+-1" stays as it is, which is no number.
std::string_view drop_plus(std::string_view word) {
  const bool is_positive = word.starts_with('+') && !word.starts_with("+-");
  return is_positive ? word.substr(1) : word;
}

// Whether the whole word spells a number, and whether double precision holds it. Microsoft's C library used
// to write "1.#QNAN", "-1.#IND" and "1.#INF".
std::errc parse(std::string_view word, double& value) {
  const std::string_view digits = drop_plus(word);
  const bool is_negative = digits.starts_with('-');
  if (const std::string_view size = digits.substr(is_negative ? 1 : 0); size.starts_with("1.#")) {
    const double special = size.starts_with("1.#INF") ? std::numeric_limits<double>::infinity()
                                                      : std::numeric_limits<double>::quiet_NaN();
    value = is_negative ? -special : special;
    return {};
  }
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return end == digits.data() + digits.size() ? error : std::errc::invalid_argument;
}

// The shortest digits that give the same number.
std::string to_text(double value) {
  char digits[32];
  const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
  return {std::begin(digits), end};
}

}  // namespace

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::string_view drop_comment(std::string_view line) {
  std::size_t at = line.find('#');
  while (at != std::string_view::npos && at > 0 && line[at - 1] == '.') at = line.find('#', at + 1);
  return line.substr(0, at);
}

std::optional<double> find_number(std::string_view word) {
  double value = 0.0;
  return parse(word, value) == std::errc() ? std::optional(value) : std::nullopt;
}

FileCursor::FileCursor(const std::string& file)
    : m_file(file), m_bytes(to_line_feeds(to_utf8(read_file(file)))) {
  if (looks_like_utf16(m_bytes))
    throw InputError(file, "", "is text in UTF-16, without a byte order mark or cut", "save it as UTF-8");
}

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

void FileCursor::expect_keyword(std::string_view expected) {
  const std::string found(peek_word().value_or(""));
  if (to_lower_case(found) != expected) expect_word(expected);
  find_word();
}

double FileCursor::any_number(std::string_view what) {
  return parse_any_number(word(what), what);
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
  throw InputError(m_file, place(offset), to_printable(problem), remedy);
}

void FileCursor::fail_truncated(std::string_view what) const {
  fail_at(m_bytes.size(), "the file ends where " + std::string(what) + " was expected",
          "it is truncated; write or copy it again");
}

void FileCursor::fail_at_vertex(std::int64_t vertex, const double* coordinates,
                                std::optional<std::size_t> offset) const {
  const std::string name = "vertex " + std::to_string(vertex);
  const double* const odd =
      std::find_if(coordinates, coordinates + 3, [](double x) { return !std::isfinite(x); });
  std::string problem = "a coordinate is not finite in metres";
  const char* remedy = "give finite coordinates and check the unit's scale";
  if (odd != coordinates + 3) {
    problem = std::string(1, "xyz"[odd - coordinates]) + " is " + to_text(*odd);
    remedy = "give a finite number";
  }
  if (offset) fail_at(*offset, name + ": " + problem, remedy);
  throw InputError(m_file, name, problem, remedy);
}

double FileCursor::parse_number(std::string_view word, std::string_view what) const {
  const double value = parse_any_number(word, what);
  if (!std::isfinite(value)) fail(std::string(what) + " is " + quote(word), "give a finite number");
  return value;
}

double FileCursor::parse_any_number(std::string_view word, std::string_view what) const {
  double value = 0.0;
  const std::errc error = parse(word, value);
  if (error == std::errc::result_out_of_range)
    fail(std::string(what) + " is " + quote(word) + ", outside the range of double precision",
         "give a number between 1e-307 and 1e308 in magnitude, or 0");
  if (error != std::errc())
    fail(std::string(what) + " is " + quote(word) + ", not a number", "give a decimal number such as 0.25");
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
