#include "scenario/setting.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/error.h"

namespace argil::scenario {
namespace {

bool is_number(const std::string& key) {
  return !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
}

/// One step along a pointer: a key, and the pointer to where it is looked up.
struct Stride {
  std::string above;
  std::string key;
};

std::vector<Stride> split(const std::string& pointer) {
  std::vector<Stride> strides;
  for (std::size_t begin = 0; begin < pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', begin + 1), pointer.size());
    strides.push_back({pointer.substr(0, begin), pointer.substr(begin + 1, end - begin - 1)});
    begin = end;
  }
  return strides;
}

/// Where a pointer that cannot be followed through `document` ends, in words.
std::string find_dead_end(const Json& document, const std::string& pointer) {
  const Json* at = &document;
  for (const auto& [above, key] : split(pointer)) {
    if (at->is_array()) {
      if (!is_number(key) || (key.size() > 1 && key[0] == '0') || key.size() > 9)
        return above + " is a list, and \"" + key + "\" is no number of an element, from 0 on";
      const std::size_t i = std::stoul(key);
      if (i >= at->size()) break;
      at = &(*at)[i];
    } else if (at->is_object()) {
      if (!at->contains(key)) break;
      at = &(*at)[key];
    } else {
      return above + " is " + at->dump() + ", which holds nothing";
    }
  }
  return "it is no JSON pointer (~ is written ~0, / in a key ~1)";
}

/// Which list lacks the element that a pointer names, in words; empty when there is none that does. One past
/// the end is a new element.
std::string find_missing_list(const Json& document, const std::string& pointer) {
  const Json* at = &document;  // null: past what is there
  for (const auto& [above, key] : split(pointer)) {
    if (at == nullptr && is_number(key)) return above + " is not set, so it has no element " + key;
    if (at != nullptr && at->is_array() && is_number(key) && key.size() <= 9) {
      const std::size_t i = std::stoul(key);
      if (i > at->size())
        return above + " has " + std::to_string(at->size()) + " elements, so none of number " + key +
               ", counted from 0";
      at = i < at->size() ? &(*at)[i] : nullptr;
    } else {
      at = at != nullptr && at->is_object() && at->contains(key) ? &(*at)[key] : nullptr;
    }
  }
  return "";
}

}  // namespace

Setting parse_setting(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (text.empty() || text[0] != '/' || equals == std::string::npos)
    throw InputError("--set", text, "is not of the form /json/pointer=value",
                     "write for instance --set /material/youngs_modulus_Pa=2e5");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::optional<Obstacle> apply_setting(Json& document, const Setting& setting) {
  Json value = setting.value;  // what is not JSON is a word
  if (Json::accept(setting.value)) value = parse_json(setting.value, "--set " + setting.pointer);
  try {
    const Json::json_pointer pointer(setting.pointer);
    if (!document.contains(pointer))
      if (const std::string list = find_missing_list(document, setting.pointer); !list.empty())
        return Obstacle{list, "set the whole list, there or in the scenario"};
    document[pointer] = value;
  } catch (const Json::exception&) {
    return Obstacle{find_dead_end(document, setting.pointer),
                    "give a pointer such as /material/youngs_modulus_Pa or /body/fixed/0/offset_m"};
  }
  return std::nullopt;
}

void apply_setting(Json& document, const Setting& setting, const std::string& file) {
  if (const auto obstacle = apply_setting(document, setting))
    throw InputError(file, setting.pointer, "cannot be set: " + obstacle->problem, obstacle->remedy);
}

}  // namespace argil::scenario
