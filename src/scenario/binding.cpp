#include "scenario/binding.h"

#include <cmath>
#include <filesystem>
#include <system_error>

#include "base/error.h"

namespace argil::scenario {
namespace {

[[noreturn]] void refuse_type(const std::string& file, const std::string& place, const Json& json,
                              const std::string& wanted) {
  throw InputError(file, place, shorten(json) + " is not " + wanted, "give " + wanted);
}

double read_number(const std::string& file, const std::string& place, const Json& json, const Range& range,
                   const std::string& unit, bool is_whole = false) {
  if (!json.is_number()) refuse_type(file, place, json, unit.empty() ? "a number" : "a number in " + unit);
  const double value = json.get<double>();
  if (!range.contains(value))
    throw InputError(
        file, place,
        shorten(json) + " is outside " + to_string(range, is_whole) + (unit.empty() ? "" : " " + unit),
        "give a value in that range");
  return value;
}

int read_integer(const std::string& file, const std::string& place, const Json& json, const Range& range) {
  if (!json.is_number_integer()) refuse_type(file, place, json, "a whole number");
  const double value = read_number(file, place, json, range, "", true);
  constexpr double kLargest = 2147483647.0;
  if (!(std::abs(value) <= kLargest))
    throw InputError(file, place, shorten(json) + " is too large", "give a whole number within ±2147483647");
  return static_cast<int>(value);
}

std::string read_text(const std::string& file, const std::string& place, const Json& json) {
  if (!json.is_string()) refuse_type(file, place, json, "a string");
  return json.get<std::string>();
}

template <int Size>
Eigen::Matrix<double, Size, 1> read_tuple(const std::string& file, const std::string& place, const Json& json,
                                          const std::string& unit) {
  if (!json.is_array() || json.size() != Size)
    refuse_type(file, place, json,
                "a list of " + std::to_string(Size) + " numbers" + (unit.empty() ? "" : " in " + unit));
  Eigen::Matrix<double, Size, 1> value;
  for (int i = 0; i < Size; ++i)
    value(i) = read_number(file, place + "/" + std::to_string(i), json[static_cast<std::size_t>(i)],
                           any_finite(), unit);
  return value;
}

}  // namespace

Parameter& Binder::add(const std::string& pointer, ValueType type, const std::string& unit,
                       const std::string& doc) {
  Parameter& row = m_rows.emplace_back();
  row.pointer = pointer;
  row.type = type;
  row.unit = unit;
  row.doc = doc;
  return row;
}

Parameter& Binder::number(const std::string& pointer, double& value, const Range& range,
                          const std::string& unit, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::number, unit, doc);
  row.range = range;
  row.read = [&value, range, unit, file = m_file](const Json& json, const std::string& place) {
    value = read_number(file, place, json, range, unit);
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::integer(const std::string& pointer, int& value, const Range& range,
                           const std::string& doc) {
  Parameter& row = add(pointer, ValueType::integer, "", doc);
  row.range = range;
  row.read = [&value, range, file = m_file](const Json& json, const std::string& place) {
    value = read_integer(file, place, json, range);
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::boolean(const std::string& pointer, bool& value, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::boolean, "", doc);
  row.read = [&value, file = m_file](const Json& json, const std::string& place) {
    if (!json.is_boolean()) refuse_type(file, place, json, "true or false");
    value = json.get<bool>();
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::text(const std::string& pointer, std::string& value, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::string, "", doc);
  row.read = [&value, file = m_file](const Json& json, const std::string& place) {
    value = read_text(file, place, json);
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::path(const std::string& pointer, std::string& value, const std::string& folder,
                        const std::string& doc) {
  Parameter& row = add(pointer, ValueType::path, "", doc);
  row.read = [&value, folder, file = m_file](const Json& json, const std::string& place) {
    const std::string text = read_text(file, place, json);
    // Absolute, so that a resolved scenario means the same files wherever it is put.
    value = text.empty()
                ? text
                : std::filesystem::absolute(std::filesystem::path(folder) / text).lexically_normal().string();
    std::error_code problem;  // too long a name, a folder that is closed; none where nothing has the name
    if (value.empty() || std::filesystem::exists(value, problem)) return;
    throw InputError(file, place,
                     "file \"" + value + "\" " +
                         (problem ? "cannot be looked up: " + problem.message() : "does not exist"),
                     "give a path relative to the scenario's folder or an absolute one");
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::vector(const std::string& pointer, Vec3& value, const std::string& unit,
                          const std::string& doc) {
  Parameter& row = add(pointer, ValueType::numbers, unit, doc);
  row.length = 3;
  row.read = [&value, unit, file = m_file](const Json& json, const std::string& place) {
    value = read_tuple<3>(file, place, json, unit);
  };
  row.write = [&value]() -> Json { return {value(0), value(1), value(2)}; };
  return row;
}

Parameter& Binder::quaternion(const std::string& pointer, Quat& value, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::numbers, "", doc);
  row.length = 4;
  row.read = [&value, file = m_file](const Json& json, const std::string& place) {
    const Vec4 q = read_tuple<4>(file, place, json, "");
    constexpr double kUnitTolerance = 1e-6;  // printed digits of a recorded quaternion
    if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance))
      throw InputError(file, place, "the quaternion's length is " + std::to_string(q.norm()) + ", not 1",
                       "give a unit quaternion x, y, z, w");
    value = device::make_unit(Quat(q(3), q(0), q(1), q(2)));
  };
  row.write = [&value]() -> Json { return {value.x(), value.y(), value.z(), value.w()}; };
  return row;
}

Parameter& Binder::numbers(const std::string& pointer, std::vector<double>& value, const Range& range,
                           const std::string& unit, const std::string& doc) {
  Parameter& row = add(pointer, ValueType::numbers, unit, doc);
  row.range = range;
  row.read = [&value, range, unit, file = m_file](const Json& json, const std::string& place) {
    if (!json.is_array()) refuse_type(file, place, json, "a list of numbers");
    value.clear();
    for (std::size_t i = 0; i < json.size(); ++i)
      value.push_back(read_number(file, place + "/" + std::to_string(i), json[i], range, unit));
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::integers(const std::string& pointer, std::vector<int>& value, const Range& range,
                            const std::string& doc) {
  Parameter& row = add(pointer, ValueType::integers, "", doc);
  row.range = range;
  row.read = [&value, range, file = m_file](const Json& json, const std::string& place) {
    if (!json.is_array()) refuse_type(file, place, json, "a list of whole numbers");
    value.clear();
    for (std::size_t i = 0; i < json.size(); ++i)
      value.push_back(read_integer(file, place + "/" + std::to_string(i), json[i], range));
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

Parameter& Binder::strings(const std::string& pointer, std::vector<std::string>& value,
                           const std::string& doc) {
  Parameter& row = add(pointer, ValueType::strings, "", doc);
  row.read = [&value, file = m_file](const Json& json, const std::string& place) {
    if (!json.is_array()) refuse_type(file, place, json, "a list of strings");
    value.clear();
    for (std::size_t i = 0; i < json.size(); ++i)
      value.push_back(read_text(file, place + "/" + std::to_string(i), json[i]));
  };
  row.write = [&value]() -> Json { return value; };
  return row;
}

int Binder::find_choice(const std::string& place, const Json& json,
                        const std::vector<std::string>& words) const {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  if (!json.is_string()) refuse_type(m_file, place, json, "one of " + list);
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == json.get<std::string>()) return static_cast<int>(i);
  const std::string nearest = find_nearest(json.get<std::string>(), words);
  throw InputError(m_file, place, shorten(json) + " is not one of " + list,
                   nearest.empty() ? "choose one of them" : "did you mean \"" + nearest + "\"?");
}

void Binder::check_list(const std::string& place, const Json& json) const {
  if (!json.is_array()) refuse_type(m_file, place, json, "a list of objects");
}

}  // namespace argil::scenario
