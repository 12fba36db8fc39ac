#include "device/csv.h"

#include <algorithm>
#include <charconv>

#include "base/lower_case.h"

namespace argil::device::internal {

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

/// Takes a quoted field from `at`, its opening quote, to behind the closing one. False when there is none.
bool take_quoted(std::string_view record, std::size_t& at, std::string& field) {
  for (++at; at < record.size(); ++at) {
    if (record[at] != '"') {
      field += record[at];
    } else if (at + 1 < record.size() && record[at + 1] == '"') {
      field += record[++at];
    } else {
      ++at;
      return true;
    }
  }
  return false;
}

}  // namespace

bool split_record(std::string_view record, char separator, std::vector<std::string>& fields) {
  const bool by_blanks = separator == ' ';
  const auto ends = [&](char c) { return by_blanks ? is_blank(c) : c == separator; };
  const auto skip_blanks = [&](std::size_t& at) {
    while (at < record.size() && is_blank(record[at]) && (by_blanks || record[at] != separator)) ++at;
  };
  if (by_blanks) record = trim(record);
  std::size_t count = 0;
  std::size_t at = 0;
  while (true) {
    if (fields.size() == count) fields.emplace_back();
    std::string& field = fields[count++];
    field.clear();
    skip_blanks(at);
    if (at < record.size() && record[at] == '"') {
      if (!take_quoted(record, at, field)) return false;
      const std::size_t after = at;
      if (!by_blanks) skip_blanks(at);
      if (at < record.size() && !ends(record[at])) return false;
      if (by_blanks) at = after;
    } else {
      std::size_t end = at;
      while (end < record.size() && !ends(record[end])) ++end;
      field = trim(record.substr(at, end - at));
      at = end;
    }
    if (at >= record.size()) break;
    ++at;  // the separator
  }
  fields.resize(count);
  return true;
}

char find_separator(std::string_view first, std::string_view second) {
  std::vector<std::string> names;
  std::vector<std::string> cells;
  char best = ',';
  long best_score = -1;
  for (const char separator : {';', '\t', ',', ' '}) {
    if (!split_record(first, separator, names)) continue;
    long score = static_cast<long>(names.size());
    if (!trim(second).empty() && split_record(second, separator, cells)) {
      const auto is_number = [](const std::string& cell) {
        return find_number(cell) || find_comma_number(cell);
      };
      // An empty last cell is a separator at the row's end.
      if (cells.size() == names.size() + 1 && cells.back().empty()) cells.pop_back();
      if (cells.size() == names.size() && names.size() >= 3)  // x y z at least
        score = 1000 * (1 + std::count_if(cells.begin(), cells.end(), is_number));
    }
    if (score > best_score) {
      best = separator;
      best_score = score;
    }
  }
  return best;
}

std::string_view name_separator(char separator) {
  return separator == ',' ? "comma" : separator == ';' ? "semicolon" : separator == '\t' ? "tab" : "blanks";
}

std::optional<double> find_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> find_comma_number(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || text.find_first_of(".,", comma + 1) != std::string_view::npos ||
      text.find('.') != std::string_view::npos)
    return std::nullopt;
  std::string pointed(text);
  pointed[comma] = '.';
  return find_number(pointed);
}

bool is_lost(std::string_view text) {
  const std::string word = to_lower_case(trim(text));
  for (const char* known : {"nan", "+nan", "-nan", "na", "n/a", "null", "none", "#n/a"})
    if (word == known) return true;
  return false;
}

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  if (text.size() <= kLongest) return "'" + std::string(text) + "'";
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // no half letter
  return "'" + std::string(text.substr(0, end)) + "…'";
}

std::string join(const std::vector<std::string>& words) {
  constexpr std::size_t kLongest = 200;
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0 && text.size() + words[i].size() > kLongest)
      return text + " and " + std::to_string(words.size() - i) + " more";
    text += (i > 0 ? ", " : "") + words[i];
  }
  return text;
}

bool LineReader::next(std::string_view& line) {
  if (m_next >= m_text.size()) return false;
  m_begin = m_next;
  std::size_t end = m_begin;
  while (end < m_text.size() && m_text[end] != '\n' && m_text[end] != '\r') ++end;
  line = m_text.substr(m_begin, end - m_begin);
  m_next = end + (m_text.substr(end, 2) == "\r\n" ? 2 : 1);
  ++m_number;
  return true;
}

}  // namespace argil::device::internal
