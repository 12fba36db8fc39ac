#include "scenario/study_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "scenario/json_reader.h"
#include "scenario/setting.h"

namespace argil::scenario {
namespace {

using Reader = JsonReader;

std::string resolve(const std::string& study, const std::string& scenario) {
  return (std::filesystem::path(study).parent_path() / scenario).lexically_normal().string();
}

std::string read_name(Reader& reader, const std::string& meaning) {
  std::string name = reader.text("name", meaning);
  if (name.find_first_not_of(" \t\n") == std::string::npos)
    reader.refuse("name", "is empty", "give " + meaning);
  return name;
}

bool has_pointer(const std::vector<Setting>& settings, const std::string& pointer) {
  return std::any_of(settings.begin(), settings.end(),
                     [&](const Setting& setting) { return setting.pointer == pointer; });
}

Curve read_curve(const Json& json, const std::string& file, const std::string& place) {
  Reader reader(json, file, place);
  Curve curve;
  curve.name = read_name(reader, "what the legend calls it");
  curve.settings = reader.settings("settings");
  const Json* along = reader.find("along");
  curve.points = along ? reader.zip("along", *along) : std::vector<std::vector<Setting>>(1);
  for (const Setting& setting : curve.points.front())
    if (has_pointer(curve.settings, setting.pointer))
      reader.refuse("settings", "\"" + setting.pointer + "\" is set by along, too",
                    "leave it out of one of them");
  reader.finish();
  return curve;
}

/// Rows of a table are told apart by the name of their curve.
void check_names(const ChartStudy& study) {
  for (std::size_t i = 0; i < study.curves.size(); ++i) {
    const std::string& name = study.curves[i].name;
    const auto refuse = [&](const std::string& owner) {
      throw InputError(study.file, "/curves/" + std::to_string(i) + "/name",
                       "\"" + name + "\" is the name of " + owner, "give each curve a name of its own");
    };
    if (name == kReferenceName || name == kRefinedName) refuse("a run of the reference");
    for (std::size_t k = 0; k < i; ++k)
      if (study.curves[k].name == name) refuse("/curves/" + std::to_string(k) + ", too");
  }
}

/// Settings put into the scene's document, later ones on top: what has no place there is refused by the
/// study that sets it.
class Scene {
 public:
  Scene(const std::string& study, const std::string& scenario) : m_study(study), m_scenario(scenario) {
    std::error_code error;
    if (!std::filesystem::exists(scenario, error))
      throw InputError(study, "/scenario", "\"" + scenario + "\" does not exist",
                       "check the path, which begins at the study's folder");
    m_document = read_json(scenario);
    if (!m_document.is_object())
      throw InputError(scenario, "", "is not a JSON object", "a scenario is {\"about\": …}");
  }
  /// With settings that stand at `place` of the study.
  [[nodiscard]] Scene with(const std::string& place, const std::vector<Setting>& settings) const {
    Scene more = *this;
    for (const Setting& setting : settings)
      if (const auto obstacle = apply_setting(more.m_document, setting))
        throw InputError(m_study, place,
                         setting.pointer + " cannot be set in " + m_scenario + ": " + obstacle->problem,
                         obstacle->remedy);
    return more;
  }

 private:
  std::string m_study;
  std::string m_scenario;
  Json m_document;
};

void check_settings(const ChartStudy& study) {
  const Scene scene = Scene(study.file, study.scenario).with("/settings", study.settings);
  static_cast<void>(scene.with("/reference", study.reference).with("/refined", study.refined));
  for (std::size_t i = 0; i < study.curves.size(); ++i) {
    const std::string place = "/curves/" + std::to_string(i);
    const Scene curve = scene.with(place + "/settings", study.curves[i].settings);
    for (const std::vector<Setting>& point : study.curves[i].points)
      static_cast<void>(curve.with(place + "/along", point));
  }
}

MapAxis read_axis(const Json& json, const std::string& file, const std::string& place) {
  Reader reader(json, file, place);
  MapAxis axis;
  axis.name = read_name(reader, "what the axis is called, with its unit");
  const Json& pointers = reader.get("pointers", "the keys that take the value");
  if (!pointers.is_array() || pointers.empty())
    reader.refuse("pointers", "is not a list", "give [\"/json/pointer\", …]");
  for (const Json& pointer : pointers) {
    if (!pointer.is_string())
      reader.refuse("pointers", pointer.dump() + " is not a text", "give JSON pointers");
    const std::string text = pointer.get<std::string>();
    reader.check_pointer("pointers", text);
    if (std::find(axis.pointers.begin(), axis.pointers.end(), text) != axis.pointers.end())
      reader.refuse("pointers", "\"" + text + "\" stands twice", "leave it out once");
    axis.pointers.push_back(text);
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
  limit.name = read_name(reader, "what the limit is called, and its source");
  limit.x = reader.numbers("x", reader.get("x", "places of the line's points"));
  if (has_y) limit.y = reader.numbers("y", reader.get("y", "places of the line's points"));
  if (has_y && limit.x.size() != limit.y.size())
    reader.refuse("y", "has another length than x", "give a pair for every point");
  reader.finish();
  return limit;
}

/// No key is of both axes.
void check_axes(const StabilityStudy& study) {
  for (const std::string& pointer : study.y.pointers)
    if (std::find(study.x.pointers.begin(), study.x.pointers.end(), pointer) != study.x.pointers.end())
      throw InputError(study.file, "/y/pointers", "\"" + pointer + "\" is set by /x, too",
                       "leave it out of one of them");
}

/// What the study says to no effect.
std::vector<std::string> list_notes(const StabilityStudy& study) {
  std::vector<std::string> notes;
  for (const auto& [axis, place] : {std::pair(&study.x, "/x"), std::pair(&study.y, "/y")})
    for (const std::string& pointer : axis->pointers)
      if (has_pointer(study.settings, pointer))
        notes.push_back(study.file + ": /settings: \"" + pointer + "\" is set by " + place +
                        ", too, whose values count; leave it out here");
  return notes;
}

void check_settings(const StabilityStudy& study) {
  const auto make_settings =
      [](const MapAxis& axis) {  // any value shows whether the scene has a place for it
        std::vector<Setting> settings;
        for (const std::string& pointer : axis.pointers) settings.push_back({pointer, "0"});
        return settings;
      };
  static_cast<void>(Scene(study.file, study.scenario)
                        .with("/settings", study.settings)
                        .with("/x/pointers", make_settings(study.x))
                        .with("/y/pointers", make_settings(study.y))
                        .with("/reference", study.reference));
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
  check_names(study);
  check_settings(study);
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
  check_axes(study);
  study.notes = list_notes(study);
  check_settings(study);
  return study;
}

}  // namespace argil::scenario
