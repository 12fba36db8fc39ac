#pragma once

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "scenario/faults.h"
#include "scenario/json_document.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Allowed numbers: from low to high, ends included or not.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open_low = false;
  bool open_high = false;
  bool contains(double x) const {  // false for NaN
    return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
  }
};
/// "[0, 1)"; `is_whole`: of whole numbers, without a decimal point.
std::string to_string(const Range& range, bool is_whole = false);

inline Range positive() {
  return {0.0, std::numeric_limits<double>::infinity(), true, true};
}
inline Range not_negative() {
  return {0.0, std::numeric_limits<double>::infinity(), false, true};
}
inline Range between(double low, double high) {
  return {low, high, false, false};
}
inline Range inside(double low, double high) {
  return {low, high, true, true};
}
inline Range any_finite() {
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), true, true};
}

enum class ValueType { number, integer, boolean, string, path, choice, numbers, integers, strings, objects };

/// One key of a scenario, bound to its place in a Scenario: the only description of it that exists.
struct Parameter {
  std::string pointer;  ///< JSON pointer, "/material/youngs_modulus_Pa"
  ValueType type = ValueType::number;
  std::string unit;  ///< empty: none
  std::string doc;   ///< meaning, source
  bool required = false;
  Range range;
  int length = 0;  ///< numbers: wanted length; 0: any
  std::vector<std::string> choices;
  std::function<std::vector<Parameter>()> item;  ///< objects: rows of one element, for schema and reference
  std::function<void(const Json&, const std::string& place)> read;  ///< checks and stores
  std::function<Json()> write;                                      ///< the stored value
  std::function<bool()> applies;  ///< false: not written by `show`, nor missed: of an alternative not taken
};

/// Is this key of no use to a static scenario? Then it is required of the others only.
bool is_of_motion(const std::string& pointer);

/// Every key, bound to `scenario`, in the order of the reference page. `file` is named in errors.
std::vector<Parameter> make_parameter_table(Scenario& scenario, const std::string& file);

/// Pointers of all keys.
const std::vector<std::string>& list_pointers();

/// Could a scenario have a value there: a key, one of its elements, or an object of keys?
bool is_possible_pointer(const std::string& pointer);

/// Checks the keys of `object` against the rows, then reads each row's value; `prefix` is put before pointers
/// in errors. All that is wrong is gathered.
void read_parameters(const std::vector<Parameter>& rows, const Json& object, const std::string& file,
                     const std::string& prefix, Faults& faults);
/// The same; throws what is wrong.
void read_parameters(const std::vector<Parameter>& rows, const Json& object, const std::string& file,
                     const std::string& prefix);

/// The rows' values as a JSON object.
Json write_parameters(const std::vector<Parameter>& rows);

}  // namespace argil::scenario
