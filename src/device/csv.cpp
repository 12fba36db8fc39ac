#include "device/csv.h"

#include <charconv>

namespace argil::device::internal {

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool split_record(std::string_view record, std::vector<std::string>& fields) {
  std::size_t count = 0;
  std::size_t at = 0;
  while (true) {
    if (fields.size() == count) fields.emplace_back();
    std::string& field = fields[count++];
    field.clear();
    while (at < record.size() && (record[at] == ' ' || record[at] == '\t')) ++at;
    if (at < record.size() && record[at] == '"') {
      for (++at;; ++at) {
        if (at >= record.size()) return false;
        if (record[at] != '"') {
          field += record[at];
        } else if (at + 1 < record.size() && record[at + 1] == '"') {
          field += record[++at];
        } else {
          break;
        }
      }
      ++at;
      while (at < record.size() && (record[at] == ' ' || record[at] == '\t')) ++at;
      if (at < record.size() && record[at] != ',') return false;
    } else {
      const std::size_t end = std::min(record.find(',', at), record.size());
      field = trim(record.substr(at, end - at));
      at = end;
    }
    if (at >= record.size()) break;
    ++at;  // the comma
  }
  fields.resize(count);
  return true;
}

std::optional<double> find_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool LineReader::next(std::string_view& line) {
  if (m_next >= m_text.size()) return false;
  m_begin = m_next;
  const std::size_t end = std::min(m_text.find('\n', m_begin), m_text.size());
  line = m_text.substr(m_begin, end - m_begin);
  if (line.ends_with('\r')) line.remove_suffix(1);
  m_next = end + 1;
  ++m_number;
  return true;
}

}  // namespace argil::device::internal
