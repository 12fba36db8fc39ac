#include "scenario/model_summary.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "contact/parameters.h"
#include "scenario/json_document.h"
#include "scenario/strain_models.h"

namespace argil::scenario {
namespace {

/// The lines as they are found, and the keys that were asked for in vain.
class Summary {
 public:
  explicit Summary(const Json& scenario) : m_scenario(scenario) {}

  void simplify(const std::string& words) { m_simplified.push_back(words); }
  void keep(const std::string& words) { m_kept.push_back(words); }
  bool has(const std::string& pointer) const { return m_scenario.contains(Json::json_pointer(pointer)); }

  /// Empty, NaN and false where the scenario does not say; NaN makes every comparison false.
  std::string word(const std::string& pointer) {
    const Json* value = find(pointer, &Json::is_string);
    return value ? value->get<std::string>() : "";
  }
  double number(const std::string& pointer) {
    const Json* value = find(pointer, &Json::is_number);
    return value ? value->get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  bool is(const std::string& pointer, bool wanted) {
    const Json* value = find(pointer, &Json::is_boolean);
    return value && value->get<bool>() == wanted;
  }

  std::string print() const {
    std::string text;
    for (const std::string& words : m_simplified) text += "simplified  " + words + '\n';
    for (const std::string& words : m_kept) text += "in full     " + words + '\n';
    for (const std::string& pointer : m_missing) text += "not said    " + pointer + '\n';
    return text;
  }

 private:
  const Json* find(const std::string& pointer, bool (Json::*is_kind)() const noexcept) {
    const Json::json_pointer place(pointer);
    if (m_scenario.contains(place) && (m_scenario.at(place).*is_kind)()) return &m_scenario.at(place);
    m_missing.push_back(pointer);
    return nullptr;
  }

  const Json& m_scenario;
  std::vector<std::string> m_simplified, m_kept, m_missing;
};

std::string print(double value) {
  if (std::isnan(value)) return "?";
  std::ostringstream out;
  out << value;
  return out.str();
}

void describe_solid(Summary& s) {
  if (const solid::ElasticLaw* law = find_law_by_name(s.word("/dynamics/model"))) {
    if (law->is_simplified) s.simplify(law->summary);
    if (!law->is_simplified) s.keep(law->summary);
  }
  const std::string element = s.word("/dynamics/element");
  if (element == "p1")
    s.simplify(
        "elements: one strain a tet (p1): too stiff where tets are coarse, lock where nearly incompressible");
  if (element == "p1_nodal")
    s.simplify(
        "elements: one strain a tet, volume averaged at vertices (p1_nodal): no locking, too stiff where "
        "coarse");
  if (element == "p2") s.keep("elements: linear strain in a tet (p2)");
  if (s.is("/dynamics/allow_locking", true))
    s.simplify("locking: allowed, so nearly incompressible tets may be far too stiff");
}

void describe_flow(Summary& s) {
  if (s.is("/material/plasticity/enabled", false)) {
    s.simplify("flow: none, the clay is elastic");
  } else if (s.word("/material/plasticity/form") == "literal") {
    s.simplify("flow: the paper's explicit update, which depends on the step");
  }
  const std::string kernel = s.word("/material/clay_kernel/form");
  const std::string radius = print(1e3 * s.number("/material/clay_kernel/radius_m")) + " mm";
  if (kernel == "rate")
    s.simplify("clay kernel: speeds fall with the distance from the tool, radius " + radius + " (eq. 9)");
  if (kernel == "per_step")
    s.simplify("clay kernel: eq. 9 once a step, as in the paper, radius " + radius + ": depends on the step");
}

void describe_water(Summary& s) {
  if (s.word("/material/moisture/law") == "effective_medium" &&
      s.is("/material/moisture/softens_elasticity", true)) {
    const double bulk = s.number("/material/effective_medium/fluid_bulk_modulus_Pa");
    if (bulk == 0.0) s.simplify("pore water: drained, it carries no pressure");
    if (bulk > 0.0)
      s.simplify("pore water: undrained, it cannot leave a tet under pressure (K = " + print(bulk) + " Pa)");
    if (s.word("/material/effective_medium/scheme") == "dilute")
      s.simplify("medium: the paper's dilute eq. 6, for little water only");
  }
  s.simplify("water: moves by diffusion alone, pressure does not drive it");
  if (s.word("/water/flux") == "two_point")
    s.simplify("diffusion: two-point flux, whose diffusivity is off on most meshes");
  if (s.word("/water/uptake") == "increment")
    s.simplify("uptake: a fixed step for every touched tet, as in the paper");
  if (s.is("/water/adds_mass", false)) s.simplify("weight of the water: left out");
  if (s.number("/water/swelling") == 0.0) s.simplify("swelling: none");
}

void describe_step(Summary& s) {
  const double period = s.number("/haptics/period_s") * s.number("/haptics/physics_period_ticks");
  const std::string step = "a step of " + print(1e3 * period) + " ms";
  const std::string integrator = s.word("/dynamics/integrator");
  const std::string iteration = s.word("/dynamics/iteration");
  if (integrator == "symplectic_euler")
    s.simplify("time: " + step + ", explicit");
  else if (iteration == "one")
    s.simplify("time: one linearised solve " + step + " (" + integrator + "), without Newton's method");
  else if (iteration == "newton")
    s.keep("time: Newton's method in " + step + " (" + integrator + ") to " +
           print(s.number("/dynamics/newton/tolerance")));
  const std::string solver = s.word("/dynamics/solver/kind");
  if (solver.starts_with("pcg"))
    s.simplify("linear solve: iterative, to a residual of " + print(s.number("/dynamics/solver/tolerance")));
  else if (!solver.empty())
    s.keep("linear solve: direct (" + solver + ")");
  const std::string extent = s.word("/dynamics/extent");
  const bool is_full = !s.has("/fidelity/mode") || s.word("/fidelity/mode") == "full";
  if (extent == "whole" || (extent == "auto" && is_full)) s.keep("extent: the whole body in every step");
  if (extent == "auto" && !is_full)
    s.simplify("extent: in a large body only the region that moves as far as the hand feels it");
  if (extent == "local")
    s.simplify("extent: only the region that moves; what is slower than " +
               print(s.number("/dynamics/region_tolerance")) + " of the fastest vertex stays");
  // Files of earlier builds were all made in full and do not say so.
  if (s.has("/fidelity/mode") && s.word("/fidelity/mode") != "full")
    s.simplify("fidelity: a step leaves out what moves the force by at most " +
               print(100.0 * s.number("/fidelity/force_tolerance")) + " % or " +
               print(s.number("/fidelity/force_floor_N")) + " N, see /fidelity");
  const double rest = s.number("/dynamics/rest_speed_m_per_s");
  if (rest > 0.0)
    s.simplify("rest: a body slower than " + print(rest) + " m/s that nothing touches is stopped");
}

void describe_contact(Summary& s) {
  const bool has_skin =
      s.has("/body/surface") || (s.has("/body/shape") && s.number("/body/shape/skin_triangles") > 0.0);
  const std::string surface = s.word("/contact/surface");
  if (surface == "cage" && has_skin)
    s.simplify("contact surface: the cage's boundary, not the skin that is drawn");
  else if (!surface.empty())
    s.keep("contact surface: the one that is drawn");
  if (s.word("/contact/law") == "pressure") {
    const double per_area = s.number("/contact/stiffness_Pa_per_m");
    s.simplify("contact: a pressure of " +
               (per_area > 0.0 ? print(per_area) + " Pa/m" : print(contact::kChosenStiffness) + " E*/cell") +
               " times the depth, over the area in touch");
  } else {
    s.simplify("contact: a penalty of " + print(s.number("/contact/vertex_face_stiffness_N_per_m")) +
               " N/m a pair, so the tool sinks in");
  }
  if (s.word("/contact/penalty") == "discrete") s.simplify("penetration: at the end of a tick only");
  if (s.number("/contact/friction") == 0.0) s.simplify("friction: none");
  if (s.is("/dynamics/implicit_contact", false)) s.simplify("contact stiffness: not in the implicit solve");
}

void describe_hand(Summary& s) {
  const double ticks = s.number("/haptics/physics_period_ticks");
  const std::string between = s.word("/haptics/between_frames");
  const std::string held = print(ticks) + " ticks";
  const bool is_pressure = s.word("/contact/law") == "pressure";
  if (ticks == 1.0) s.keep("force: new in every tick");
  if (ticks > 1.0 && between == "hold")
    s.simplify("force: held for " + held + ", between physics steps (hold)");
  if (ticks > 1.0 && between != "hold" && is_pressure)
    s.simplify("force: the last answer of the clay, carried on for up to " + held + " as it yields (" +
               between + ")");
  if (ticks > 1.0 && between == "re_evaluate" && !is_pressure)
    s.simplify("force: contact every tick, with the surface as it was up to " + held + " ago (re_evaluate)");
  if (ticks > 1.0 && between == "compliant" && !is_pressure)
    s.simplify("force: contact every tick, with a surface that is predicted for up to " + held +
               " (compliant)");
  if (s.word("/hand/kind") == "prescribed")
    s.simplify(s.word("/trace/file").empty()
                   ? "hand: was a program's own, whose rule is not in the file"
                   : "hand: goes where the trace goes and does not yield to the force");
  if (s.word("/haptics/passivity") == "time_domain")
    s.simplify("passivity: the device's force is damped where it would give energy");
}

}  // namespace

std::string describe_model(const std::string& resolved, const std::string& file, bool is_session) {
  const Json scenario = parse_json(resolved, file);
  Summary summary(scenario);
  describe_solid(summary);
  describe_water(summary);
  if (summary.word("/dynamics/mode") == "static") {
    summary.simplify("time: one elastic equilibrium, without flow, tool and water's motion");
  } else {
    describe_flow(summary);
    describe_step(summary);
    describe_contact(summary);
    if (is_session)
      summary.simplify(
          "force: rests on the last surface that the physics had ready, whatever its age (live)");
    else
      describe_hand(summary);
  }
  summary.simplify("scene: one body and a rigid tool; the body does not meet itself and cannot be cut");
  return summary.print();
}

}  // namespace argil::scenario
