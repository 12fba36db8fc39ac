#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "scenario/json_document.h"
#include "scenario/parameter_table.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// An object of a JSON file, read key by key; a key that no one asked for is an error.
class JsonReader {
 public:
  JsonReader(const Json& json, std::string file, std::string place)
      : m_json(json), m_file(std::move(file)), m_place(std::move(place)) {
    if (!json.is_object()) refuse("", "is not an object", "give {…}");
  }

  const Json* find(const std::string& key) {
    m_known.push_back(key);
    return m_json.contains(key) ? &m_json[key] : nullptr;
  }
  const Json& get(const std::string& key, const std::string& meaning) {
    const Json* value = find(key);
    if (!value) refuse(key, "is missing", "add it: " + meaning);
    return *value;
  }
  std::string text(const std::string& key, const std::string& meaning) {
    const Json& value = get(key, meaning);
    if (!value.is_string()) refuse(key, value.dump() + " is not a text", "give " + meaning);
    return value.get<std::string>();
  }
  double number(const std::string& key, double fallback, double least, double most) {
    const Json* value = find(key);
    if (!value) return fallback;
    if (!value->is_number() || !(value->get<double>() >= least && value->get<double>() <= most))
      refuse(key, value->dump() + " is outside [" + Json(least).dump() + ", " + Json(most).dump() + "]",
             "give a number in it");
    return value->get<double>();
  }
  /// Without a `fallback` it must be there.
  std::int64_t whole_number(const std::string& key, std::int64_t least, std::int64_t most,
                            std::optional<std::int64_t> fallback = std::nullopt) {
    if (!fallback) get(key, "a whole number");
    const double value = number(key, static_cast<double>(fallback.value_or(least)),
                                static_cast<double>(least), static_cast<double>(most));
    if (value != std::floor(value)) refuse(key, m_json[key].dump() + " is not whole", "give a whole number");
    return static_cast<std::int64_t>(value);
  }
  bool flag(const std::string& key, bool fallback) {
    const Json* value = find(key);
    if (!value) return fallback;
    if (!value->is_boolean()) refuse(key, value->dump() + " is neither true nor false", "give one of them");
    return value->get<bool>();
  }
  std::vector<double> numbers(const std::string& key, const Json& list) const {
    std::vector<double> values;
    if (!list.is_array() || list.empty())
      refuse(key, "is not a list of numbers", "give for instance [1, 2, 5]");
    for (const Json& value : list) {
      if (!value.is_number()) refuse(key, value.dump() + " is not a number", "give numbers only");
      values.push_back(value.get<double>());
    }
    return values;
  }
  /// Memory of a setting.
  static std::size_t count_bytes(const std::string& pointer, std::size_t value_size = 0) {
    return sizeof(Setting) + pointer.size() + value_size;
  }
  /// Refuses settings of a study that take more than it is given, before they are made.
  void check_bytes(const std::string& key, std::size_t bytes) const {
    constexpr std::size_t kMost = std::size_t{512} << 20;
    if (bytes > kMost)
      refuse(key, "makes settings of " + std::to_string(bytes >> 20) + " MiB in memory, more than 512",
             "take fewer or shorter values, or put what does not vary into the scenario");
  }
  /// {"/pointer": value, …}
  std::vector<Setting> settings(const std::string& key) {
    const Json* object = find(key);
    std::vector<Setting> list;
    if (!object) return list;
    if (!object->is_object()) refuse(key, "is not an object", "give {\"/json/pointer\": value, …}");
    for (const auto& [pointer, value] : object->items()) {
      check_pointer(key, pointer);
      list.push_back({pointer, value.dump()});
    }
    return list;
  }
  /// {"/pointer": [values…], …}
  const Json& axes(const std::string& key, const Json& object) const {
    if (!object.is_object() || object.empty())
      refuse(key, "is not an object of axes", "give {\"/json/pointer\": [values], …}");
    std::size_t bytes = 0;
    for (const auto& [pointer, values] : object.items()) {
      check_pointer(key, pointer);
      if (!values.is_array() || values.empty())
        refuse(key, pointer + " has no list of values", "give for instance [1, 2, 5]");
      bytes += values.size() * count_bytes(pointer);
    }
    check_bytes(key, bytes);
    return object;
  }
  /// Axes of one length, taken together.
  std::vector<std::vector<Setting>> zip(const std::string& key, const Json& object) const {
    std::vector<std::vector<Setting>> points(axes(key, object).begin()->size());
    for (const auto& [pointer, values] : object.items()) {
      if (values.size() != points.size())
        refuse(key,
               pointer + " has " + std::to_string(values.size()) + " values, the first axis " +
                   std::to_string(points.size()),
               "give lists of one length; they are taken together");
      for (std::size_t i = 0; i < points.size(); ++i) points[i].push_back({pointer, values[i].dump()});
    }
    return points;
  }
  void check_pointer(const std::string& key, const std::string& pointer) const {
    if (pointer.empty() || pointer[0] != '/')
      refuse(key, "\"" + pointer + "\" is no JSON pointer", "begin it with /, as in /dynamics/model");
    if (is_possible_pointer(pointer)) return;
    const std::string near = find_nearest(pointer, list_pointers());
    refuse(key, "\"" + pointer + "\" is no key of a scenario",
           near.empty() ? "argil schema --reference lists them" : "did you mean " + near + "?");
  }
  /// After all keys were asked for.
  void finish() const {
    for (const auto& [key, value] : m_json.items())
      if (std::find(m_known.begin(), m_known.end(), key) == m_known.end()) {
        std::string list;
        for (const std::string& known : m_known) list += (list.empty() ? "" : ", ") + known;
        const std::string near = find_nearest(key, m_known);
        refuse(key, "is not a known key",
               (near.empty() ? "remove it; " : "did you mean " + near + "? ") + ("known here are: " + list));
      }
  }
  [[noreturn]] void refuse(const std::string& key, const std::string& problem,
                           const std::string& remedy) const {
    throw InputError(m_file, m_place + (key.empty() ? "" : "/" + escape_key(key)), problem, remedy);
  }
  std::string place(const std::string& key) const { return m_place + "/" + escape_key(key); }

 private:
  const Json& m_json;
  std::string m_file;
  std::string m_place;
  std::vector<std::string> m_known;
};

}  // namespace argil::scenario
