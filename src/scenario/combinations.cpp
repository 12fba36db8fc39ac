#include "scenario/combinations.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/error.h"
#include "material/moisture.h"
#include "material/plasticity.h"
#include "scenario/json_document.h"
#include "scenario/medium_check.h"
#include "scenario/strain_models.h"
#include "sim/extent.h"

namespace argil::scenario {
namespace {

void check_rates(const Scenario& s) {
  const sim::RateParams& r = s.params.rates;
  Faults faults(s.file);
  for (const auto& [pointer, value] : {std::pair{"/haptics/water_period_ticks", r.water_period_ticks},
                                       {"/haptics/frame_period_ticks", r.frame_period_ticks}}) {
    const int period = r.physics_period_ticks;
    if (value % period == 0) continue;
    faults.add(
        InputError(s.file, pointer,
                   std::to_string(value) + " is no multiple of physics_period_ticks (" +
                       std::to_string(period) + ")",
                   "give a multiple of it, for instance " + std::to_string((value / period + 1) * period))
            .what());
  }
  faults.throw_all();
}

/// A surface that yields between frames needs the matrix of an implicit step, and a step that knows of it.
void check_between_frames(const Scenario& s) {
  const solid::SolidParams& p = s.params.solid;
  if (s.mode != Mode::dynamic || !s.params.deflects_between_steps()) return;
  const char* place = "/haptics/between_frames";
  if (p.integrator == solid::Integrator::symplectic_euler)
    throw InputError(s.file, place,
                     "compliant takes the matrix of an implicit step, which symplectic_euler has not",
                     "use another /dynamics/integrator, or re_evaluate");
  if (!p.implicit_contact)
    throw InputError(s.file, place, "compliant needs contact stiffness in the implicit step",
                     "set /dynamics/implicit_contact to true, or use re_evaluate");
}

/// Exact shapes of the tools that are drawn as triangles.
std::optional<contact::RoundTool> find_round_tool(const ToolSpec& t) {
  switch (t.kind) {
    case ToolKind::sphere:
      return contact::RoundTool{t.radius, 0.0, t.radius, false};
    case ToolKind::capsule:
      return contact::RoundTool{t.radius, t.length, t.radius, false};
    case ToolKind::stylus:
      return contact::RoundTool{t.tip_radius, t.length, t.radius, true};
    case ToolKind::mesh:
      break;
  }
  return std::nullopt;
}

/// What the tool meets: where the scenario does not say, by the pressure law the skin if the body has one, by
/// that of pairs (the paper) the cage.
sim::SurfaceKind choose_surface(const Scenario& s) {
  if (s.params.contact_surface != sim::SurfaceKind::automatic) return s.params.contact_surface;
  const bool has_skin =
      s.body.kind == BodyKind::surface || (s.body.kind == BodyKind::shape && s.body.skin_triangles > 0);
  const bool meets_skin = has_skin && s.params.contact.law == contact::ContactLaw::pressure;
  return meets_skin ? sim::SurfaceKind::skin : sim::SurfaceKind::cage;
}

void check_contact(Scenario& s) {
  contact::ContactParams& c = s.params.contact;
  s.params.contact_surface = choose_surface(s);
  c.round_tool = find_round_tool(s.tool);
  if (c.law == contact::ContactLaw::pairs) return;
  if (c.damping > 0.0)
    throw InputError(s.file, "/contact/damping_s_per_m", "is of the pairs' law, not of the pressure law",
                     "leave it out, or set /contact/law to pairs");
  if (c.friction > 0.0 && !s.params.solid.solves_contact())
    throw InputError(s.file, "/contact/friction", "of the pressure law is found in an implicit step",
                     "set /dynamics/implicit_contact to true, or set /contact/law to pairs");
  const material::Plasticity& flow = s.params.plasticity;
  if (c.grip_strength > 0.0 || !flow.enabled) return;
  const double shear_modulus =
      s.params.elastic.youngs_modulus / (2.0 * (1.0 + s.params.elastic.poissons_ratio));
  c.grip_strength =
      8.0 * std::numbers::sqrt2 * shear_modulus * material::compute_yield_strain(flow, s.params.elastic);
}

void check_tables(const Scenario& s) {
  const material::Moisture& m = s.params.moisture;
  if (m.law == material::MoistureLaw::liquidity_index &&
      !(m.liquid_limit_saturation > m.plastic_limit_saturation))
    throw InputError(s.file, "/material/moisture/liquid_limit_saturation",
                     Json(m.liquid_limit_saturation).dump() + " is not above the plastic limit's " +
                         Json(m.plastic_limit_saturation).dump(),
                     "give the liquid limit the larger saturation");
  if (m.law != material::MoistureLaw::table) return;
  const std::vector<double>& S = m.table_saturation;
  const char* place = "/material/moisture/table_saturation";
  const char* remedy = "give saturations that increase from 0 to 1, at least [0, 1]";
  if (S.empty()) throw InputError(s.file, place, "is empty, but /material/moisture/law is table", remedy);
  if (S.front() != 0.0)
    throw InputError(s.file, place, "begins with " + Json(S.front()).dump() + " and not with 0", remedy);
  for (std::size_t i = 1; i < S.size(); ++i)
    if (!(S[i] > S[i - 1]))
      throw InputError(s.file, place + ("/" + std::to_string(i)),
                       Json(S[i]).dump() + " is not above the " + Json(S[i - 1]).dump() + " before it",
                       remedy);
  if (S.back() != 1.0)
    throw InputError(s.file, place, "ends with " + Json(S.back()).dump() + " and not with 1", remedy);
  if (m.table_youngs_modulus.size() != S.size() || m.table_yield.size() != S.size())
    throw InputError(s.file, place,
                     "has " + std::to_string(S.size()) + " values, table_youngs_modulus_Pa " +
                         std::to_string(m.table_youngs_modulus.size()) + ", table_yield " +
                         std::to_string(m.table_yield.size()),
                     "give the three lists the same length");
}

/// Pores' axis of unit length.
void normalise_axis(Scenario& s) {
  Vec3& axis = s.params.moisture.medium.axis;
  constexpr double kRounding = 1e-15;
  if (!(axis.norm() > 0.0))
    throw InputError(s.file, "/material/effective_medium/axis", "has no length",
                     "give for instance [0, 0, 1]");
  if (!(std::abs(axis.norm() - 1.0) <= kRounding)) axis.normalize();
}

/// Eq. 6 over all that the run can reach, as far as the scenario alone tells; with fields of a mesh that is
/// asked once they are read.
void check_medium(Scenario& s) {
  normalise_axis(s);
  if (needs_fields(s)) return;
  const double E = s.params.elastic.youngs_modulus;
  const MediumCheck check = check_effective_medium(s, {E, E, s.params.water.initial_saturation});
  s.medium_status = check.status;
  if (!check.warning.empty()) s.warnings.push_back(check.warning);
}

/// A field that says where pores lie, of pores that lie nowhere in particular?
void check_pore_axes(Scenario& s) {
  const material::Moisture& m = s.params.moisture;
  if (s.body.pore_axis_field.empty()) return;
  const std::string place = "/body/mesh/pore_axis_field";
  const std::string text = "\"" + s.body.pore_axis_field + "\" has no effect: ";
  if (m.medium.orientation == material::Orientation::random)
    throw InputError(s.file, place, text + "the pores' orientation is random",
                     "set /material/effective_medium/orientation to aligned, or leave it empty");
  if (m.law != material::MoistureLaw::effective_medium || !m.softens_elasticity ||
      material::is_isotropic(m.medium))
    s.warnings.push_back(s.file + ": " + place + ": " + text +
                         "water leaves this clay isotropic (moisture law, scheme and aspect)");
}

/// An extent that a run cannot have: refused where it is asked for, else `whole` instead of `automatic`.
void check_extent(Scenario& s) {
  sim::Extent& extent = s.params.extent;
  if (extent == sim::Extent::whole) return;
  std::optional<sim::RegionObstacle> obstacle = sim::find_region_obstacle(s.params, s.body.fixed);
  if (s.mode != Mode::dynamic) obstacle = {"is for steps in time", "set /dynamics/mode to dynamic"};
  if (!obstacle) return;
  if (extent == sim::Extent::local)
    throw InputError(s.file, "/dynamics/extent", std::string("local ") + obstacle->reason,
                     std::string(obstacle->remedy) + ", or use whole");
  extent = sim::Extent::whole;
}

/// What the elements and laws cannot do together.
void check_solid(Scenario& s) {
  const solid::SolidParams& p = s.params.solid;
  const bool is_second_order =
      p.integrator == solid::Integrator::bdf2 || p.integrator == solid::Integrator::newmark;
  if (s.mode == Mode::dynamic && is_second_order && p.iteration == solid::Iteration::one &&
      !find_law(p.model).is_linear)
    s.warnings.push_back(
        s.file +
        ": /dynamics/iteration: one linearised solve with bdf2 or newmark gains energy where "
        "the body turns (results/verification); newton does not");
  if (s.mode == Mode::equilibrium && p.integrator != solid::Integrator::backward_euler)
    s.warnings.push_back(
        s.file +
        ": /dynamics/integrator has no effect: an equilibrium (/dynamics/mode static) has no "
        "step in time");
  if (s.mode == Mode::dynamic && p.integrator == solid::Integrator::symplectic_euler &&
      p.iteration == solid::Iteration::newton)
    s.warnings.push_back(
        s.file + ": /dynamics/iteration has no effect: symplectic_euler is explicit and solves nothing");
  const bool takes_full_stiffness = find_law(p.model).takes_full_stiffness;
  const bool needs_isotropy = !takes_full_stiffness || p.element == solid::ElementKind::p1_nodal;
  if (needs_isotropy && !material::is_isotropic(s.params.moisture))
    throw InputError(s.file, takes_full_stiffness ? "/dynamics/element" : "/dynamics/model",
                     "takes isotropic stiffness only, but the pores are aligned spheroids",
                     "use the corotational or linear model with p1 or p2, or orientation random");
  if (p.element == solid::ElementKind::p1_nodal && s.params.plasticity.enabled &&
      !s.params.plasticity.deviatoric)
    throw InputError(s.file, "/dynamics/element", "p1_nodal needs plastic flow that keeps the volume",
                     "set /material/plasticity/deviatoric to true, or use p1 or p2");
}

/// A law that does not bear inversion has no forces at det F ≤ 0, where a step must not go on.
void check_inversion(const Scenario& s) {
  const solid::ElasticLaw& law = find_law(s.params.solid.model);
  if (!law.bears_inversion && !(s.params.solid.min_volume_ratio >= 0.0))
    throw InputError(s.file, "/dynamics/min_volume_ratio",
                     Json(s.params.solid.min_volume_ratio).dump() + " is outside [0, 1] for " + law.name +
                         ", which has no stress where a tet is inverted",
                     "give 0 or more");
}

void require_normal(const Scenario& s, const solid::Region& region, const std::string& pointer) {
  const bool has_normal =
      region.kind == solid::Region::Kind::half_space || region.kind == solid::Region::Kind::plane;
  if (has_normal && !(region.normal.norm() > 0.0))
    throw InputError(s.file, pointer + "/normal", "has no length", "give for instance [0, 0, 1]");
}

void check_regions(const Scenario& s) {
  for (std::size_t i = 0; i < s.body.fixed.size(); ++i)
    require_normal(s, s.body.fixed[i].region, "/body/fixed/" + std::to_string(i));
  for (std::size_t i = 0; i < s.body.loads.pressure.size(); ++i)
    require_normal(s, s.body.loads.pressure[i].region, "/body/loads/pressure/" + std::to_string(i));
}

/// Does any flow rule ever let clay flow?
bool can_flow(const Scenario& s) {
  const material::Plasticity& law = s.params.plasticity;
  return law.enabled && (law.form == material::FlowForm::j2 || law.creep_per_s > 0.0);
}

/// Flow of a law of large strain keeps the volume, and is measured by the deviator's norm.
void check_flow_of_model(const Scenario& s) {
  const solid::ElasticLaw& law = find_law(s.params.solid.model);
  if (law.plastic_split == solid::PlasticSplit::none && s.mode == Mode::dynamic && can_flow(s))
    throw InputError(s.file, "/dynamics/model",
                     std::string(law.name) + " is a law of clay that does not flow",
                     "take hencky, or set /material/plasticity/enabled to false");
  if (law.plastic_split != solid::PlasticSplit::logarithmic || s.mode != Mode::dynamic) return;
  const material::Plasticity& flow = s.params.plasticity;
  if (!flow.deviatoric || flow.norm != material::StrainNorm::frobenius)
    throw InputError(s.file, "/material/plasticity",
                     std::string("flow of ") + law.name + " keeps the volume, in the Frobenius norm",
                     "set deviatoric to true and norm to \"frobenius\"");
  if (flow.max > 0.0)
    throw InputError(s.file, "/material/plasticity/max",
                     Json(flow.max).dump() + ", but flow of " + law.name + " has no cap",
                     "leave it out, or give 0");
}

/// Strength is one number, a stress or a strain.
void check_strength(const Scenario& s) {
  const material::Plasticity& law = s.params.plasticity;
  if (!(law.strength > 0.0)) return;
  const std::string place = "/material/plasticity/strength_Pa";
  if (law.yield > 0.0) throw InputError(s.file, place, "is given, and yield too", "leave one of them out");
  if (s.params.moisture.law == material::MoistureLaw::table)
    throw InputError(s.file, place, "is given, but /material/moisture/table_yield says when clay flows",
                     "leave it out, or take another moisture law");
}

void check_plasticity(Scenario& s) {
  const material::Plasticity& law = s.params.plasticity;
  if (law.rate_growth > 0.0 && law.form != material::FlowForm::j2)
    throw InputError(s.file, "/material/plasticity/rate_growth_per_decade",
                     "is given, but only the strength of j2 rises with the rate",
                     "set /material/plasticity/form to j2, or leave it out");
  if (!law.enabled) return;
  check_strength(s);
  check_flow_of_model(s);
  const std::string place = "/material/plasticity/form";
  if (law.form == material::FlowForm::j2 && !(law.deviatoric && law.norm == material::StrainNorm::frobenius))
    throw InputError(s.file, place, "j2 is a law of the deviator's Frobenius norm",
                     "set deviatoric to true and norm to \"frobenius\"");
  if (law.form == material::FlowForm::j2 && !material::is_isotropic(s.params.moisture))
    throw InputError(s.file, place, "j2 is a law of isotropic clay, but the pores are aligned spheroids",
                     "take rate_to_yield, or orientation random");
  const double flow = law.creep_per_s * s.params.rates.physics_period_ticks * s.params.rates.haptic_period;
  if (law.form == material::FlowForm::literal && !(flow <= 1.0))
    throw InputError(s.file, place,
                     "literal flow of creep_per_s times the physics step, " + Json(flow).dump() +
                         ", takes more than the whole elastic strain (allowed: [0, 1])",
                     "shorten the step or lower creep_per_s, or take rate");
  // F_p = 1 + ε_p must stay a stretch: no eigenvalue of ε_p may reach −1.
  const double most = law.norm == material::StrainNorm::frobenius ? 1.0 : std::sqrt(0.5);
  const solid::ElasticLaw& elastic = find_law(s.params.solid.model);
  const bool flows = s.mode == Mode::dynamic && can_flow(s);
  if (elastic.plastic_split == solid::PlasticSplit::multiplicative &&
      ((flows && !(law.max > 0.0)) || !(law.max < most)))
    throw InputError(s.file, "/material/plasticity/max",
                     Json(law.max).dump() + " is outside (0, " + Json(most).dump() + ") for " + elastic.name +
                         ", whose plastic stretch would lose a dimension",
                     "lower it, or use corotational");
}

void check_tool(const Scenario& s) {
  if (s.tool.kind == ToolKind::mesh && s.tool.file.empty())
    throw InputError(s.file, "/tool/shape/file", "is missing", "name the tool's surface");
  if (s.tool.kind == ToolKind::stylus && !(s.tool.tip_radius < s.tool.radius))
    throw InputError(s.file, "/tool/shape/tip_radius_m", "is not smaller than radius_m",
                     "give a sharper tip");
}

void check_kernel(Scenario& s) {
  const sim::Params& p = s.params;
  if (s.mode == Mode::equilibrium) {
    if (p.plasticity.enabled && (p.plasticity.yield > 0.0 || p.plasticity.strength > 0.0))
      s.warnings.push_back(s.file +
                           ": /material/plasticity: static mode is elastic; plastic flow is left out");
    return;
  }
  if (p.kernel.form != material::KernelForm::off && !(p.kernel.radius > 0.0))
    throw InputError(s.file, "/material/clay_kernel/radius_m", "is 0", "give R_D in metres, or form \"off\"");
}

/// Cells are chosen by the motion, and by a force that converges as they get smaller.
void check_accuracy(const Scenario& s) {
  if (s.accuracy == 0.0) return;
  const std::string place = "/fidelity/accuracy";
  if (s.mode == Mode::equilibrium)
    throw InputError(s.file, place, "is that of the force at the hand, but a static run has none",
                     "leave it out, or set /dynamics/mode to dynamic");
  if (s.params.contact.law != contact::ContactLaw::pressure)
    throw InputError(s.file, place, "is given, but the force of pairs follows the number of triangles",
                     "set /contact/law to pressure");
}

}  // namespace

void check_combinations(Scenario& s, Faults& faults) {
  const auto check = [&](void (*function)(Scenario&)) { return faults.check([&] { function(s); }); };
  const auto check_only = [&](void (*function)(const Scenario&)) {
    return faults.check([&] { function(s); });
  };
  check_only(check_regions);
  check(check_plasticity);
  check(check_solid);
  check_only(check_inversion);
  check_only(check_rates);
  check_only(check_between_frames);
  check(check_contact);
  check(check_extent);
  const bool has_tables = check_only(check_tables);
  check(check_pore_axes);
  if (has_tables) check(check_medium);
  check_only(check_tool);
  check(check_kernel);
  check_only(check_accuracy);
}

}  // namespace argil::scenario
