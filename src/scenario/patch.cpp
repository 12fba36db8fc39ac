#include "scenario/patch.h"

#include "base/error.h"
#include "scenario/json_document.h"

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

}  // namespace

std::string print_patch(const std::vector<Setting>& settings) {
  Json patch = Json::object();
  for (const Setting& setting : settings)
    patch[Json::json_pointer(setting.pointer)] =
        Json::accept(setting.value) ? Json::parse(setting.value) : Json(setting.value);
  return patch.dump(2) + "\n";
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
