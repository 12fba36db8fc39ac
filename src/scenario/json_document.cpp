#include "scenario/json_document.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <set>

#include "base/error.h"
#include "base/read_file.h"
#include "base/text_encoding.h"

namespace argil::scenario {
namespace {

constexpr int kMaxDepth = 64;
constexpr std::uintmax_t kMaxBytes = 64u << 20;
constexpr std::size_t kMaxKeys = 10000;  // of one object; each is compared with those before

/// "line L, column C" of a byte offset.
std::string describe_place(const std::string& text, std::size_t byte) {
  const std::size_t end = std::min(byte == 0 ? 0 : byte - 1, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  const std::size_t start = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  const std::size_t column = start == std::string::npos ? end + 1 : end - start;
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

std::size_t compute_edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replace, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Follows the parser through a document and knows where it is.
class PlaceWatcher {
 public:
  /// False when a key stands twice in its object.
  bool follow(Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        begin_element();
        m_levels.emplace_back();
        m_levels.back().is_array = event == Json::parse_event_t::array_start;
        return true;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        m_levels.pop_back();
        return true;
      case Json::parse_event_t::key:
        m_levels.back().key = parsed.get<std::string>();
        return m_levels.back().keys.insert(m_levels.back().key).second;
      case Json::parse_event_t::value:
        begin_element();
        return true;
    }
    return true;
  }
  /// Of the object that it is in.
  std::size_t num_keys() const { return m_levels.empty() ? 0 : m_levels.back().keys.size(); }
  std::string pointer() const {
    std::string text;
    for (const Level& level : m_levels)
      text += "/" + (level.is_array ? std::to_string(level.index) : escape_key(level.key));
    return text;
  }

 private:
  struct Level {
    bool is_array = false;
    int index = -1;
    std::string key;
    std::set<std::string> keys;
  };
  void begin_element() {
    if (!m_levels.empty() && m_levels.back().is_array) ++m_levels.back().index;
  }
  std::vector<Level> m_levels;
};

}  // namespace

std::string shorten(const Json& json) {
  const std::string text = json.dump();
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string escape_key(const std::string& key) {
  std::string text;
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

Json parse_json(const std::string& text, const std::string& file) {
  PlaceWatcher place;
  const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kMaxDepth)
      throw InputError(file, "", "is nested deeper than " + std::to_string(kMaxDepth) + " levels",
                       "flatten it");
    if (!place.follow(event, parsed))
      throw InputError(file, place.pointer(), "stands twice in one object", "keep one of the two");
    if (place.num_keys() > kMaxKeys)
      throw InputError(file, place.pointer(),
                       "is one key more than the " + std::to_string(kMaxKeys) + " that an object may have",
                       "is this the right file?");
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::parse_error& error) {
    const std::string what = error.what();
    const std::size_t detail = what.rfind(": ");
    throw InputError(file, describe_place(text, error.byte),
                     "is not JSON (" + what.substr(detail == std::string::npos ? 0 : detail + 2) + ")",
                     "correct it there; comments are not allowed");
  } catch (const Json::out_of_range& error) {
    throw InputError(file, "", std::string("holds a number that is too large (") + error.what() + ")",
                     "give a number within ±1.8e308");
  }
}

Json read_json(const std::string& file) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(file, missing);
  if (missing) throw InputError(file, "", "cannot be read (" + missing.message() + ")", "check the path");
  if (size > kMaxBytes)
    throw InputError(file, "", "is larger than 64 MiB", "a scenario is small; is this the right file?");
  return parse_json(to_utf8(read_file(file)), file);
}

std::string find_nearest(const std::string& key, const std::vector<std::string>& keys) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(3, key.size() / 2) + 1;
  for (const std::string& candidate : keys) {
    const std::size_t distance = compute_edit_distance(key, candidate);
    // A key that only lacks its unit or its beginning is near, too.
    const bool part = key.size() >= 4 && candidate.find(key) != std::string::npos;
    const std::size_t rank = part ? std::min<std::size_t>(distance, 2) : distance;
    if (rank < least) {
      least = rank;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace argil::scenario
