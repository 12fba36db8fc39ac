#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenario/parameter_table.h"

namespace argil::scenario {

/// Makes rows of the table: each binds one key to the variable that holds it, whose present value is the
/// default.
class Binder {
 public:
  explicit Binder(std::string file) : m_file(std::move(file)) {}

  Parameter& number(const std::string& pointer, double& value, const Range& range, const std::string& unit,
                    const std::string& doc);
  Parameter& integer(const std::string& pointer, int& value, const Range& range, const std::string& doc);
  Parameter& boolean(const std::string& pointer, bool& value, const std::string& doc);
  Parameter& text(const std::string& pointer, std::string& value, const std::string& doc);
  /// A file name, taken relative to `folder`; shown as it is used.
  Parameter& path(const std::string& pointer, std::string& value, const std::string& folder,
                  const std::string& doc);
  Parameter& vector(const std::string& pointer, Vec3& value, const std::string& unit, const std::string& doc);
  Parameter& quaternion(const std::string& pointer, Quat& value, const std::string& doc);
  Parameter& numbers(const std::string& pointer, std::vector<double>& value, const Range& range,
                     const std::string& unit, const std::string& doc);
  Parameter& integers(const std::string& pointer, std::vector<int>& value, const Range& range,
                      const std::string& doc);
  Parameter& strings(const std::string& pointer, std::vector<std::string>& value, const std::string& doc);

  /// One of several words.
  template <class Enum>
  Parameter& choice(const std::string& pointer, Enum& value,
                    const std::vector<std::pair<Enum, std::string>>& words, const std::string& doc);

  /// A list of objects whose keys `describe(binder, element)` binds.
  template <class Element, class Describe>
  Parameter& objects(const std::string& pointer, std::vector<Element>& value, Describe describe,
                     const std::string& doc);

  std::vector<Parameter> take() { return std::move(m_rows); }
  const std::string& file() const { return m_file; }

 private:
  Parameter& add(const std::string& pointer, ValueType type, const std::string& unit, const std::string& doc);
  int find_choice(const std::string& place, const Json& json, const std::vector<std::string>& words) const;
  void check_list(const std::string& place, const Json& json) const;

  std::string m_file;
  std::vector<Parameter> m_rows;
};

template <class Enum>
Parameter& Binder::choice(const std::string& pointer, Enum& value,
                          const std::vector<std::pair<Enum, std::string>>& words, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::choice, "", doc);
  for (const auto& word : words) row.choices.push_back(word.second);
  const Binder checker(m_file);
  row.read = [&value, words, choices = row.choices, checker](const Json& json, const std::string& place) {
    value = words[static_cast<std::size_t>(checker.find_choice(place, json, choices))].first;
  };
  row.write = [&value, words]() -> Json {
    for (const auto& word : words)
      if (word.first == value) return word.second;
    return nullptr;
  };
  return row;
}

template <class Element, class Describe>
Parameter& Binder::objects(const std::string& pointer, std::vector<Element>& value, Describe describe,
                           const std::string& doc) {
  Parameter& row = add(pointer, ValueType::objects, "", doc);
  const auto rows_of = [describe, file = m_file](Element& element) {
    Binder binder(file);
    describe(binder, element);
    return binder.take();
  };
  row.item = [rows_of] {
    static thread_local Element sample;  // only its rows' descriptions are looked at
    sample = Element();
    return rows_of(sample);
  };
  const Binder checker(m_file);
  row.read = [&value, rows_of, checker, file = m_file](const Json& json, const std::string& place) {
    checker.check_list(place, json);
    value.clear();
    Faults faults(file);
    for (std::size_t i = 0; i < json.size(); ++i) {
      value.emplace_back();
      read_parameters(rows_of(value.back()), json[i], file, place + "/" + std::to_string(i), faults);
    }
    faults.throw_all();
  };
  row.write = [&value, rows_of]() -> Json {
    Json list = Json::array();
    for (Element& element : value) list.push_back(write_parameters(rows_of(element)));
    return list;
  };
  return row;
}

}  // namespace argil::scenario
