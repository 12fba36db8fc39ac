#include "scenario/patch.h"

#include "base/error.h"
#include "scenario/json_document.h"
#include "scenario/setting.h"

namespace argil::scenario {
namespace {

void add_settings(const Json& patch, const std::string& pointer, const std::string& file,
                  std::vector<Setting>& settings) {
  for (const auto& [key, value] : patch.items()) {
    const std::string below = pointer + "/" + escape_key(key);
    if (value.is_null())
      throw InputError(file, below, "is null: a patch takes no key away",
                       "give a value, or leave the key out");
    if (value.is_object())
      add_settings(value, below, file, settings);
    else
      settings.push_back({below, value.dump()});
  }
}

/// Lists of numbers or words in one line. No string of a patch holds a line break.
std::string with_short_lists(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t end = text[at] == '[' ? text.find_first_of("]{[", at + 1) : std::string::npos;
    if (end == std::string::npos || text[end] != ']') {
      out += text[at];
      continue;
    }
    for (; at <= end; ++at) {  // a break with its indent is one blank, and none beside a bracket
      if (text[at] != '\n') {
        out += text[at];
        continue;
      }
      at = text.find_first_not_of(' ', at + 1) - 1;
      if (out.back() != '[' && text[at + 1] != ']') out += ' ';
    }
    --at;
  }
  return out;
}

}  // namespace

std::string print_patch(const std::vector<Setting>& settings) {
  return print_patch(settings, {}, "");
}

std::string print_patch(const std::vector<Setting>& settings, const std::vector<Setting>& over,
                        const std::string& file) {
  Json patch = Json::object();
  for (const Setting& setting : settings)
    patch[Json::json_pointer(setting.pointer)] =
        Json::accept(setting.value) ? Json::parse(setting.value) : Json(setting.value);
  for (const Setting& setting : over) apply_setting(patch, setting, file);
  return with_short_lists(patch.dump(2)) + "\n";
}

std::string describe_differences(const std::string& a, const std::string& b, int most) {
  if (!Json::accept(a) || !Json::accept(b)) return "";
  std::string text;
  int count = 0;
  for (const auto& change : Json::diff(Json::parse(a), Json::parse(b)))
    if (++count <= most) text += (count > 1 ? ", " : "") + change["path"].get<std::string>();
  return count > most ? text + " and " + std::to_string(count - most) + " more" : text;
}

std::string quote(const std::string& text) {
  return Json(text).dump();
}

std::vector<Setting> read_patch(const std::string& file) {
  const Json patch = read_json(file);
  if (!patch.is_object())
    throw InputError(file, "", "is not an object of a scenario's keys",
                     "write for instance {\"material\": {\"youngs_modulus_Pa\": 2e5}}");
  std::vector<Setting> settings;
  add_settings(patch, "", file, settings);
  return settings;
}

}  // namespace argil::scenario
