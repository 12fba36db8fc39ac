#include "scenario/scenario.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "scenario/combinations.h"
#include "scenario/doubts.h"
#include "scenario/file_faults.h"
#include "scenario/parameter_table.h"
#include "scenario/scenario_text.h"
#include "scenario/scene_faults.h"
#include "scenario/setting.h"

namespace argil::scenario {
namespace {

// The paper to the letter, where it is silent the nearest reading (see README.md of this folder).
constexpr const char* kPaperPreset = R"({
  "material": {
    "effective_medium": {"scheme": "dilute"},
    "plasticity": {"form": "literal", "norm": "voigt6", "deviatoric": false},
    "clay_kernel": {"form": "per_step"}
  },
  "water": {"uptake": "increment"},
  "contact": {"law": "pairs", "face_blend": 0},
  "dynamics": {"model": "linear", "implicit_contact": false, "strict": true},
  "haptics": {"physics_period_ticks": 14, "water_period_ticks": 14, "frame_period_ticks": 98, "between_frames": "hold"}
})";

void choose_body(Scenario& s, const Json& document) {
  if (document.contains("body") && !document["body"].is_object()) return;  // which its keys say
  if (!document.contains("body"))
    throw InputError(s.file, "/body", "is missing", "add one of /body/mesh, /body/shape, /body/surface");
  const Json& body = document["body"];
  const int count =
      static_cast<int>(body.contains("mesh") + body.contains("shape") + body.contains("surface"));
  if (count != 1)
    throw InputError(s.file, "/body", "has " + std::to_string(count) + " of mesh, shape and surface",
                     "give exactly one of them: a run has one body");
  s.body.kind = body.contains("mesh")    ? BodyKind::mesh
                : body.contains("shape") ? BodyKind::shape
                                         : BodyKind::surface;
  const char* key = s.body.kind == BodyKind::mesh ? "mesh" : "surface";
  if (s.body.kind != BodyKind::shape && (!body[key].is_object() || !body[key].contains("file")))
    throw InputError(s.file, std::string("/body/") + key + "/file", "is missing",
                     "name the file of the body");
}

/// Which keys are asked for depends on the mode, so it is read first.
void choose_mode(Scenario& s, const Json& document) {
  const Json dynamics = document.value("dynamics", Json::object());
  if (dynamics.is_object() && dynamics.value("mode", Json()) == "static") s.mode = Mode::equilibrium;
}

double find_number(const Json& document, const char* place) {
  const Json value = document.value(Json::json_pointer(place), Json());
  return value.is_number() ? value.get<double>() : 0.0;
}

/// What is taken where nothing else is asked for. A body that is made here is the surface, and its cells are
/// small where the tool comes; cells that a file gives stay. There strain is large: elastic clay follows
/// Curnier's law, clay that flows Hencky's, with von Mises's flow where its strength is a stress. Flow of a
/// strength that is a strain would turn small cells inside out, and the pairs' law is the paper's.
void choose_model(Scenario& s, const Json& document) {
  const bool has_strength = find_number(document, "/material/plasticity/strength_Pa") > 0.0;
  const bool may_flow =
      document.value(Json::json_pointer("/material/plasticity/enabled"), Json(true)) != false;
  const bool flows_by_strain = may_flow && find_number(document, "/material/plasticity/yield") > 0.0;
  const bool flows = has_strength || find_number(document, "/material/plasticity/creep_per_s") > 0.0 ||
                     document.value(Json::json_pointer("/material/plasticity/form"), Json()) == "j2";
  const bool is_aligned =
      document.value(Json::json_pointer("/material/effective_medium/orientation"), Json()) == "aligned";
  const bool has_pairs = document.value(Json::json_pointer("/contact/law"), Json()) == "pairs";
  const bool has_cells =
      s.body.kind == BodyKind::mesh || document.contains(Json::json_pointer("/body/surface/cage"));
  const Json kernel = document.value(Json::json_pointer("/material/clay_kernel"), Json::object());
  for (const char* key : {"k1_per_m", "k2_per_m", "radius_m"})  // whose constants are given, it is meant
    if (kernel.is_object() && kernel.contains(key)) s.params.kernel.form = material::KernelForm::rate;
  if (has_strength) s.params.plasticity.form = material::FlowForm::j2;
  if (has_strength) s.params.solid.model = solid::StrainModel::hencky;
  if (has_cells || s.mode != Mode::dynamic || has_pairs) return;
  s.body.fit = embed::Fit::surface;
  if (flows_by_strain) return;
  s.body.cells.kind = CellKind::graded;
  if (!is_aligned)
    s.params.solid.model = may_flow && flows ? solid::StrainModel::hencky : solid::StrainModel::curnier;
}

/// A scenario that was written when the pairs' law was the only one: what it gives for that does not count.
void leave_out_pairs(Scenario& s, const Json& document) {
  const Json contact = document.value("contact", Json::object());
  if (contact.contains("law")) return;
  s.params.contact.damping = 0.0;
  for (const char* key : {"vertex_face_stiffness_N_per_m", "edge_edge_stiffness_N_per_m", "damping_s_per_m"})
    if (contact.contains(key)) {
      s.warnings.push_back(s.file + ": /contact/" + key +
                           ": is of the pairs' law; the pressure law acts, whose stiffness follows from the "
                           "clay. Leave it out, or set /contact/law to pairs");
      return;
    }
}

bool is_of_trace(const std::string& pointer) {
  return pointer.starts_with("/trace/");
}

Scenario load_document(Json document, const std::string& file, const std::vector<Setting>& settings,
                       MotionSource motion, FaultFinder find_more) {
  if (!document.is_object())
    throw InputError(file, "", "is not a JSON object", "a scenario is {\"about\": …}");
  for (const Setting& setting : settings) apply_setting(document, setting, file);
  const Json given = document;
  const Json preset = document.value("preset", Json("none"));
  if (preset == "paper") {
    Json below = Json::parse(kPaperPreset);
    below.merge_patch(document);
    document = below;
  }
  Scenario s;
  s.file = file;
  Faults faults(file);
  faults.check([&] { choose_body(s, document); });
  choose_mode(s, document);
  choose_model(s, document);
  std::vector<Parameter> table = make_parameter_table(s, file);
  if (motion == MotionSource::device)
    for (Parameter& row : table) row.required = row.required && !is_of_trace(row.pointer);
  read_parameters(table, document, file, "", faults);
  if (faults.empty()) {
    leave_out_pairs(s, document);
    check_combinations(s, faults);
  }
  if (faults.empty())
    for (std::string& doubt : list_doubts(s)) s.warnings.push_back(std::move(doubt));
  else
    find_more(s, faults);
  faults.throw_all(given);
  return s;
}

}  // namespace

Scenario::Scenario() {
  params.extent = sim::Extent::automatic;
  params.contact.law = contact::ContactLaw::pressure;
  params.contact_surface = sim::SurfaceKind::automatic;
  params.is_strict = false;
  params.kernel.form = material::KernelForm::off;
}

Scenario load_scenario(const std::string& file, const std::vector<Setting>& settings, MotionSource motion) {
  return load_scenario(file, settings, motion, find_file_faults);
}

Scenario load_scenario(const std::string& file, const std::vector<Setting>& settings, MotionSource motion,
                       FaultFinder find_more) {
  return load_document(read_json(file), file, settings, motion, find_more);
}

Scenario load_text(const std::string& text, const std::string& file, const std::vector<Setting>& settings,
                   MotionSource motion) {
  return load_text(text, file, settings, motion, find_file_faults);
}

Scenario load_text(const std::string& text, const std::string& file, const std::vector<Setting>& settings,
                   MotionSource motion, FaultFinder find_more) {
  return load_document(parse_json(text, file), file, settings, motion, find_more);
}

std::vector<InputFile> list_input_files(const Scenario& scenario) {
  Scenario copy = scenario;
  std::vector<InputFile> list = {{"", scenario.file}};
  for (const Parameter& row : make_parameter_table(copy, scenario.file)) {
    if (row.type != ValueType::path || (row.applies && !row.applies())) continue;
    const std::filesystem::path file = row.write().get<std::string>();
    if (file.empty()) continue;
    list.push_back({row.pointer, file.string()});
    for (const auto& [one, other] : {std::pair{".node", ".ele"}, std::pair{".ele", ".node"}})
      if (file.extension() == one)
        list.push_back({row.pointer, std::filesystem::path(file).replace_extension(other).string()});
  }
  return list;
}

std::string print_resolved(const Scenario& scenario) {
  Scenario copy = scenario;
  return write_parameters(make_parameter_table(copy, scenario.file)).dump(2) + "\n";
}

std::string print_portable(const Scenario& scenario, const std::vector<Setting>& unchecked) {
  Scenario copy = scenario;
  // Absolute both: the same text however the scenario was named.
  const std::filesystem::path folder =
      std::filesystem::absolute(scenario.file).lexically_normal().parent_path();
  Json object = Json::object();
  for (const Parameter& row : make_parameter_table(copy, scenario.file)) {
    if (row.applies && !row.applies()) continue;
    Json value = row.write();
    if (row.type == ValueType::path && value != "") {
      const std::filesystem::path file = value.get<std::string>();
      value = std::filesystem::absolute(file).lexically_normal().lexically_relative(folder).generic_string();
    }
    object[Json::json_pointer(row.pointer)] = value;
  }
  for (const Setting& setting : unchecked) apply_setting(object, setting, scenario.file);
  return object.dump(2) + "\n";
}

}  // namespace argil::scenario
