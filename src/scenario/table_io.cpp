// Reading and writing by the table, and the two descriptions that are printed from it.

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "base/error.h"
#include "scenario/parameter_table.h"

namespace argil::scenario {
namespace {

std::string print_number(double x, bool is_whole) {
  if (std::isinf(x)) return x > 0 ? "∞" : "−∞";
  if (is_whole) return std::to_string(static_cast<long long>(x));
  return Json(x).dump();
}

/// Keys that may stand directly below `pointer`.
std::vector<std::string> find_keys_below(const std::vector<Parameter>& rows, const std::string& pointer) {
  std::vector<std::string> keys;
  for (const Parameter& row : rows) {
    if (row.pointer.rfind(pointer + "/", 0) != 0) continue;
    const std::size_t begin = pointer.size() + 1;
    const std::string key = row.pointer.substr(begin, row.pointer.find('/', begin) - begin);
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
  return keys;
}

/// By which editors find the schema of a file.
constexpr const char* kSchemaKey = "$schema";

bool is_key(const std::vector<Parameter>& rows, const std::string& pointer) {
  return std::any_of(rows.begin(), rows.end(), [&](const Parameter& row) { return row.pointer == pointer; });
}

/// Of lists of bodies or tools, which there are not.
std::string say_one(const Json& value, const std::string& pointer) {
  return value.is_array() && (pointer == "/body" || pointer == "/tool")
             ? ": a run has one body and one rigid tool"
             : "";
}

void check_keys(const std::vector<Parameter>& rows, const Json& object, const std::string& pointer,
                const std::string& file, const std::string& prefix, Faults& faults) {
  if (!object.is_object()) {
    faults.add(InputError(file, prefix + pointer, shorten(object) + " is not an object",
                          "give an object {…}" + say_one(object, prefix + pointer))
                   .what());
    return;
  }
  const std::vector<std::string> allowed = find_keys_below(rows, pointer);
  for (const auto& [key, value] : object.items()) {
    if (key == kSchemaKey && (prefix + pointer).empty() && value.is_string()) continue;
    const std::string below = pointer + "/" + escape_key(key);
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      std::string list;
      for (const std::string& word : allowed) list += (list.empty() ? "" : ", ") + word;
      const std::string nearest = find_nearest(key, allowed);
      const InputError fault(file, prefix + below, "is not a known key",
                             (nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ") +
                                 ("known here are: " + list) +
                                 (prefix.empty() && pointer.empty() ? say_one(value, "/" + nearest) : ""));
      faults.add(fault.what());
      if (!nearest.empty()) faults.add_misspelt(prefix + pointer + "/" + escape_key(nearest));
    } else if (!is_key(rows, below)) {
      check_keys(rows, value, below, file, prefix, faults);
    }
  }
}

const char* schema_type(ValueType type) {
  switch (type) {
    case ValueType::number:
      return "number";
    case ValueType::integer:
      return "integer";
    case ValueType::boolean:
      return "boolean";
    case ValueType::string:
    case ValueType::path:
    case ValueType::choice:
      return "string";
    default:
      return "array";
  }
}

void add_range(Json& schema, const Range& range) {
  if (std::isfinite(range.low)) schema[range.open_low ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) schema[range.open_high ? "exclusiveMaximum" : "maximum"] = range.high;
}

Json make_schema(const std::vector<Parameter>& rows);

Json make_value_schema(const Parameter& row) {
  Json schema;
  schema["type"] = schema_type(row.type);
  schema["description"] = row.doc + (row.unit.empty() ? "" : " [" + row.unit + "]");
  switch (row.type) {
    case ValueType::number:
    case ValueType::integer:
      add_range(schema, row.range);
      break;
    case ValueType::choice:
      schema["enum"] = row.choices;
      break;
    case ValueType::numbers:
    case ValueType::integers:
      schema["items"] = {{"type", row.type == ValueType::numbers ? "number" : "integer"}};
      add_range(schema["items"], row.range);
      if (row.length > 0) schema["minItems"] = schema["maxItems"] = row.length;
      break;
    case ValueType::strings:
      schema["items"] = {{"type", "string"}};
      break;
    case ValueType::objects:
      schema["items"] = make_schema(row.item());
      break;
    default:
      break;
  }
  if (!row.required && row.write) schema["default"] = row.write();
  return schema;
}

Json make_schema(const std::vector<Parameter>& rows) {
  Json root = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  for (const Parameter& row : rows) {
    Json* at = &root;
    std::istringstream path(row.pointer.substr(1));
    std::string key;
    std::getline(path, key, '/');
    for (std::string next; std::getline(path, next, '/'); key = next) {
      if (row.required) {
        Json& required = (*at)["required"];
        if (std::find(required.begin(), required.end(), key) == required.end()) required.push_back(key);
      }
      Json& below = (*at)["properties"][key];
      if (below.is_null())
        below = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
      at = &below;
    }
    (*at)["properties"][key] = make_value_schema(row);
    if (row.required) (*at)["required"].push_back(key);
  }
  return root;
}

/// Demands the key at `pointer` and every object on the way to it.
void require_below(Json& schema, const std::string& pointer) {
  const std::size_t end = pointer.find('/', 1);
  const std::string key = pointer.substr(1, end == std::string::npos ? end : end - 1);
  Json& required = schema["required"];
  if (std::find(required.begin(), required.end(), key) == required.end()) required.push_back(key);
  if (end != std::string::npos) require_below(schema["properties"][key], pointer.substr(end));
}

std::string describe_default(const Parameter& row) {
  if (!row.required) return "`" + row.write().dump() + "`";
  if (row.applies && !row.applies()) return "required where it counts";
  return is_of_motion(row.pointer) ? "required unless static" : "required";
}

}  // namespace

std::string to_string(const Range& range, bool is_whole) {
  return (range.open_low ? "(" : "[") + print_number(range.low, is_whole) + ", " +
         print_number(range.high, is_whole) + (range.open_high ? ")" : "]");
}

void read_parameters(const std::vector<Parameter>& rows, const Json& object, const std::string& file,
                     const std::string& prefix, Faults& faults) {
  check_keys(rows, object, "", file, prefix, faults);
  for (const Parameter& row : rows) {
    const Json::json_pointer pointer(row.pointer);
    const std::string place = prefix + row.pointer;
    if (object.contains(pointer))
      faults.check([&] { row.read(object[pointer], place); });
    else if (row.required && (!row.applies || row.applies()) && !faults.explains(place))
      faults.add(InputError(file, place, "is missing",
                            "add it: " + row.doc + (row.unit.empty() ? "" : " [" + row.unit + "]"))
                     .what());
  }
}

void read_parameters(const std::vector<Parameter>& rows, const Json& object, const std::string& file,
                     const std::string& prefix) {
  Faults faults(file);
  read_parameters(rows, object, file, prefix, faults);
  faults.throw_all();
}

Json write_parameters(const std::vector<Parameter>& rows) {
  Json object = Json::object();
  for (const Parameter& row : rows)
    if (!row.applies || row.applies()) object[Json::json_pointer(row.pointer)] = row.write();
  return object;
}

std::string print_schema() {
  Scenario defaults;
  std::vector<Parameter> rows = make_parameter_table(defaults, "scenario.json");
  Json of_motion = Json::object();
  Json of_pairs = Json::object();  // of the contact's law that is not the default
  for (Parameter& row : rows) {
    if (!row.required || !is_of_motion(row.pointer)) continue;
    row.required = false;
    row.write = nullptr;  // still no default
    require_below(row.applies && !row.applies() ? of_pairs : of_motion, row.pointer);
  }
  of_motion["properties"]["contact"] = {
      {"if", {{"required", {"law"}}, {"properties", {{"law", {{"const", "pairs"}}}}}}},
      {"then", of_pairs["properties"]["contact"]}};
  Json schema = make_schema(rows);
  schema["if"] = {
      {"required", {"dynamics"}},
      {"properties",
       {{"dynamics", {{"required", {"mode"}}, {"properties", {{"mode", {{"const", "static"}}}}}}}}}};
  schema["else"] = of_motion;
  schema["properties"]["body"]["oneOf"] = {
      {{"required", {"mesh"}}}, {{"required", {"shape"}}}, {{"required", {"surface"}}}};
  schema["required"].push_back("body");
  schema["properties"][kSchemaKey] = {
      {"type", "string"}, {"description", "Where this schema lies, for an editor; argil does not read it."}};
  Json page = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "argil scenario"}};
  page.update(schema);
  return page.dump(2) + "\n";
}

std::string print_reference() {
  Scenario defaults;
  std::ostringstream page;
  page << "| key | unit | allowed | default | meaning |\n|---|---|---|---|---|\n";
  const auto print_rows = [&page](const std::vector<Parameter>& rows, const std::string& prefix,
                                  auto&& self) -> void {
    for (const Parameter& row : rows) {
      std::string allowed;
      for (const std::string& word : row.choices) allowed += (allowed.empty() ? "" : ", ") + word;
      if (row.type == ValueType::number || row.type == ValueType::integer)
        allowed = to_string(row.range, row.type == ValueType::integer);
      page << "| `" << prefix << row.pointer << "` | " << row.unit << " | " << allowed << " | "
           << describe_default(row) << " | " << row.doc << " |\n";
      if (row.item) self(row.item(), prefix + row.pointer + "/N", self);
    }
  };
  print_rows(make_parameter_table(defaults, "scenario.json"), "", print_rows);
  return page.str();
}

const std::vector<std::string>& list_pointers() {
  static const std::vector<std::string> list = [] {
    Scenario scenario;
    std::vector<std::string> pointers;
    for (const Parameter& row : make_parameter_table(scenario, "")) pointers.push_back(row.pointer);
    return pointers;
  }();
  return list;
}

bool is_possible_pointer(const std::string& pointer) {
  const auto is_below = [](const std::string& a, const std::string& b) { return a.rfind(b + "/", 0) == 0; };
  return std::any_of(list_pointers().begin(), list_pointers().end(), [&](const std::string& known) {
    return pointer == known || is_below(pointer, known) || is_below(known, pointer);
  });
}

}  // namespace argil::scenario
