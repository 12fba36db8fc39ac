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
  reader.find("$schema");
  reader.finish();
  return options;
}

std::string print_tolerance_schema() {
  const auto number = [](const char* about) {
    return Json{{"type", "number"}, {"description", about}, {"minimum", 0}, {"default", 0}};
  };
  const Json rule = {
      {"type", "object"},
      {"additionalProperties", false},
      {"properties",
       {{"dataset", {{"type", "string"}, {"description", "Path of a dataset; * stands for any text."}}},
        {"absolute", number("In the dataset's unit.")},
        {"relative", number("Of the value in the first file.")},
        {"of_largest", number("Of the dataset's largest value in the first file.")}}},
      {"required", {"dataset"}}};
  const Json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "argil tolerances"},
      {"type", "object"},
      {"additionalProperties", false},
      {"properties",
       {{"$schema", {{"type", "string"}, {"description", "Where this schema lies, for an editor."}}},
        {"ignore",
         {{"type", "array"},
          {"description", "Paths that are left out with everything in them; * stands for any text."},
          {"items", {{"type", "string"}}}}},
        {"tolerances",
         {{"type", "array"},
          {"description", "The first whose dataset fits counts; what none fits must have the same bits."},
          {"items", rule}}}}}};
  return schema.dump(2) + "\n";
}

}  // namespace argil::scenario
