#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace argil::mesh_files {

/// `text` without blanks and carriage returns at both ends.
std::string_view trim(std::string_view text);

/// `line` up to its comment. The # of "1.#IND" begins none.
std::string_view drop_comment(std::string_view line);

/// The number that the whole word spells, which may be NaN or infinite; nothing where it spells none.
std::optional<double> find_number(std::string_view word);

/// The same number with its bytes in the order of this machine, read from `bytes` in order `order`.
template <class T>
T load_bytes(const char* bytes, std::endian order) {
  char copy[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i)
    copy[i] = bytes[order == std::endian::native ? i : sizeof(T) - 1 - i];
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

/// A whole file in memory and a place in it that moves forward over words, lines or bytes. Every failure is
/// an InputError that names the file and the line, or the byte in a file that is binary. Numbers never depend
/// on the locale.
class FileCursor {
 public:
  /// Throws IoError when the file cannot be read, InputError where it is in UTF-16 that cannot be told
  /// surely.
  explicit FileCursor(const std::string& file);

  const std::string& file() const { return m_file; }
  std::string_view bytes() const { return m_bytes; }
  std::size_t offset() const { return m_offset; }
  /// Where the last word, line or bytes began.
  std::size_t last_offset() const { return m_last; }
  std::size_t remaining() const { return m_bytes.size() - m_offset; }
  void seek(std::size_t offset);

  /// From now on failures name bytes, not lines.
  void set_binary() { m_is_binary = true; }
  /// Words that begin with `mark` end at the end of their line and are skipped with it.
  void set_comment_mark(char mark) { m_comment_mark = mark; }

  /// Next word; nothing at the end of the file.
  std::optional<std::string_view> find_word();
  /// Next word without moving on.
  std::optional<std::string_view> peek_word();
  /// Next word, which must exist. `what` says in a message what was expected.
  std::string_view word(std::string_view what);
  /// Next word, which must be exactly `expected`.
  void expect_word(std::string_view expected);
  /// The same in letters of either case; `expected` is in small ones.
  void expect_keyword(std::string_view expected);
  /// Next word as a finite number.
  double number(std::string_view what);
  /// Next word as a number that may be NaN or infinite, for what nothing may come to use.
  double any_number(std::string_view what);
  /// Next word as a whole number.
  std::int64_t integer(std::string_view what);
  /// Next word as a number of things, not negative, each of which takes at least `bytes_each` bytes of what
  /// is left of the file: a small file cannot ask for a large memory.
  std::int64_t count(std::string_view what, std::size_t bytes_each);

  /// Rest of the present line, trimmed; moves to the next. Nothing at the end of the file.
  std::optional<std::string_view> find_line();
  /// The next `size` bytes.
  std::string_view take(std::size_t size, std::string_view what);
  template <class T>
  T binary(std::string_view what, std::endian order = std::endian::little) {
    return load_bytes<T>(take(sizeof(T), what).data(), order);
  }
  /// Refuses a number of things that is negative or needs more than what is left of the file.
  void require_room(std::int64_t count, std::size_t bytes_each, std::string_view what) const;

  /// Throws an InputError that names the last word, line or bytes taken.
  [[noreturn]] void fail(std::string_view problem, std::string_view remedy) const;
  [[noreturn]] void fail_at(std::size_t offset, std::string_view problem, std::string_view remedy) const;
  [[noreturn]] void fail_truncated(std::string_view what) const;
  /// Refuses a vertex in use whose three coordinates are not finite in metres. `offset`: where it stands, if
  /// that is known.
  [[noreturn]] void fail_at_vertex(std::int64_t vertex, const double* coordinates,
                                   std::optional<std::size_t> offset = std::nullopt) const;

  /// Numbers of a word that belongs to this file; for readers that split lines themselves.
  double parse_number(std::string_view word, std::string_view what) const;
  double parse_any_number(std::string_view word, std::string_view what) const;
  std::int64_t parse_integer(std::string_view word, std::string_view what) const;

 private:
  void skip_blanks();
  std::string place(std::size_t offset) const;

  std::string m_file;
  std::string m_bytes;
  std::size_t m_offset = 0;
  std::size_t m_last = 0;
  bool m_is_binary = false;
  char m_comment_mark = '\0';
};

/// Words of one line, left to right.
class WordsOf {
 public:
  explicit WordsOf(std::string_view line) : m_rest(line) {}
  /// Next word; empty at the end.
  std::string_view next();

 private:
  std::string_view m_rest;
};

}  // namespace argil::mesh_files
