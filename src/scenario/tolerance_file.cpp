#include "scenario/tolerance_file.h"

#include <limits>

#include "scenario/json_reader.h"

namespace argil::scenario {
namespace {

constexpr double kMost = std::numeric_limits<double>::max();

const Json& require_list(const JsonReader& reader, const std::string& key, const Json& list) {
  if (!list.is_array()) reader.refuse(key, "is not a list", "give [ … ]");
  return list;
}

}  // namespace

output::CompareOptions load_tolerances(const std::string& file) {
  const Json json = read_json(file);
  JsonReader reader(json, file, "");
  output::CompareOptions options;
  options.file = file;
  if (const Json* ignore = reader.find("ignore"))
    for (const Json& path : require_list(reader, "ignore", *ignore)) {
      if (!path.is_string())
        reader.refuse("ignore", path.dump() + " is not a text", "give paths such as \"/frames/*\"");
      options.ignore.push_back(path.get<std::string>());
    }
  if (const Json* list = reader.find("tolerances"))
    for (std::size_t i = 0; i < require_list(reader, "tolerances", *list).size(); ++i) {
      JsonReader entry((*list)[i], file, reader.place("tolerances") + "/" + std::to_string(i));
      output::Tolerance tolerance;
      tolerance.dataset = entry.text("dataset", "the path of a dataset, * for any text");
      tolerance.relative = entry.number("relative", 0.0, 0.0, kMost);
      tolerance.absolute = entry.number("absolute", 0.0, 0.0, kMost);
      tolerance.of_largest = entry.number("of_largest", 0.0, 0.0, kMost);
      entry.finish();
      options.tolerances.push_back(tolerance);
    }
  reader.finish();
  return options;
}

}  // namespace argil::scenario
