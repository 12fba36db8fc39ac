#include "scenario/study_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "scenario/json_reader.h"

namespace argil::scenario {
namespace {

using Reader = JsonReader;

std::string resolve(const std::string& study, const std::string& scenario) {
  return (std::filesystem::path(study).parent_path() / scenario).lexically_normal().string();
}

Curve read_curve(const Json& json, const std::string& file, const std::string& place) {
  Reader reader(json, file, place);
  Curve curve;
  curve.name = reader.text("name", "what the legend calls it");
  curve.settings = reader.settings("settings");
  const Json* along = reader.find("along");
  curve.points = along ? reader.zip("along", *along) : std::vector<std::vector<Setting>>(1);
  reader.finish();
  return curve;
}

MapAxis read_axis(const Json& json, const std::string& file, const std::string& place) {
  Reader reader(json, file, place);
  MapAxis axis;
  axis.name = reader.text("name", "what the axis is called, with its unit");
  const Json& pointers = reader.get("pointers", "the keys that take the value");
  if (!pointers.is_array() || pointers.empty())
    reader.refuse("pointers", "is not a list", "give [\"/json/pointer\", …]");
  for (const Json& pointer : pointers) {
    if (!pointer.is_string())
      reader.refuse("pointers", pointer.dump() + " is not a text", "give JSON pointers");
    axis.pointers.push_back(pointer.get<std::string>());
    reader.check_pointer("pointers", axis.pointers.back());
  }
  axis.is_logarithmic = reader.flag("logarithmic", false);
  axis.is_integer = reader.flag("integers", false);
  axis.values = reader.numbers("values", reader.get("values", "increasing numbers"));
  if (std::adjacent_find(axis.values.begin(), axis.values.end(), std::greater_equal<>()) != axis.values.end())
    reader.refuse("values", "do not increase", "sort them and leave out what stands twice");
  if (axis.is_integer && std::any_of(axis.values.begin(), axis.values.end(),
                                     [](double value) { return value != std::round(value); }))
    reader.refuse("values", "hold a number that is not whole", "give whole ones, or integers false");
  if (axis.is_logarithmic && !(axis.values.front() > 0.0))
    reader.refuse("values", "hold a number that has no logarithm",
                  "give positive ones, or logarithmic false");
  reader.finish();
  return axis;
}

MapLimit read_limit(const Json& json, const std::string& file, const std::string& place, bool has_y) {
  Reader reader(json, file, place);
  MapLimit limit;
  limit.name = reader.text("name", "what the limit is called, and its source");
  limit.x = reader.numbers("x", reader.get("x", "places of the line's points"));
  if (has_y) limit.y = reader.numbers("y", reader.get("y", "places of the line's points"));
  if (has_y && limit.x.size() != limit.y.size())
    reader.refuse("y", "has another length than x", "give a pair for every point");
  reader.finish();
  return limit;
}

}  // namespace

ChartStudy read_chart_study(const std::string& file) {
  const Json json = read_json(file);
  Reader reader(json, file, "");
  ChartStudy study;
  study.file = file;
  study.about = reader.text("about", "what the chart is to show");
  study.scenario = resolve(file, reader.text("scenario", "the scene's file"));
  study.settings = reader.settings("settings");
  study.reference = reader.settings("reference");
  study.refined = reader.settings("refined");
  if (study.refined.empty())
    reader.refuse("refined", "is missing",
                  "add what refines the reference once more, so that its own error is known");
  study.repeats = static_cast<int>(reader.whole_number("repeats", 1, 99, 3));
  const Json& curves = reader.get("curves", "the methods to compare");
  if (!curves.is_array() || curves.empty())
    reader.refuse("curves", "is not a list", "give [{\"name\": …}, …]");
  for (std::size_t i = 0; i < curves.size(); ++i)
    study.curves.push_back(read_curve(curves[i], file, reader.place("curves") + "/" + std::to_string(i)));
  reader.finish();
  return study;
}

StabilityStudy read_stability_study(const std::string& file) {
  const Json json = read_json(file);
  Reader reader(json, file, "");
  StabilityStudy study;
  study.file = file;
  study.about = reader.text("about", "what the map is to show");
  study.scenario = resolve(file, reader.text("scenario", "the scene's file"));
  study.settings = reader.settings("settings");
  study.x = read_axis(reader.get("x", "the axis along which boundaries are found"), file, reader.place("x"));
  if (const Json* y = reader.find("y")) study.y = read_axis(*y, file, reader.place("y"));
  study.reference = reader.settings("reference");
  study.wrong_above = reader.number("wrong_above", study.wrong_above, 0.0, 1e6);
  study.bisect_to = reader.number("bisect_to", study.bisect_to, 0.0, 1.0);
  if (const Json* limits = reader.find("limits")) {
    if (!limits->is_array()) reader.refuse("limits", "is not a list", "give [{\"name\": …, \"x\": […]}, …]");
    for (std::size_t i = 0; i < limits->size(); ++i)
      study.limits.push_back(read_limit((*limits)[i], file, reader.place("limits") + "/" + std::to_string(i),
                                        !study.y.values.empty()));
  }
  reader.finish();
  return study;
}

std::string print_patch(const std::vector<Setting>& settings) {
  Json patch = Json::object();
  for (const Setting& setting : settings)
    patch[Json::json_pointer(setting.pointer)] =
        Json::accept(setting.value) ? Json::parse(setting.value) : Json(setting.value);
  return patch.dump(2) + "\n";
}

}  // namespace argil::scenario
