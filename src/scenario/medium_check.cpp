#include "scenario/medium_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "material/effective_medium.h"

namespace argil::scenario {
namespace {

constexpr double kLockingPoissonsRatio = 0.45;  // a bar of 4-node tets bends a third of the truth there
constexpr const char* kScheme = "/material/effective_medium/scheme";

const std::string& name_of(material::Scheme scheme) {
  const auto& names = scheme_names();
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.first == scheme; })->second;
}

/// Can the tool give water?
bool can_wet(const Scenario& s) {
  const water::WaterParams& w = s.params.water;
  const double uptake = w.uptake == water::UptakeForm::flux ? w.wetting_flux : w.saturation_increment;
  const bool may_be_wet = s.tool.mode == ModeChoice::wet || s.tool.mode == ModeChoice::trace;
  return s.mode == Mode::dynamic && may_be_wet && uptake > 0.0;
}

double compute_poissons_ratio(const material::MediumResult& medium) {
  const double K = medium.bulk_modulus;
  const double G = medium.shear_modulus;
  return (3.0 * K - 2.0 * G) / (2.0 * (3.0 * K + G));
}

/// "drained" or "undrained", with E where tets differ.
std::string describe_clay(const Scenario& s, const ClayRange& range, double E) {
  std::ostringstream text;
  text << (s.params.moisture.medium.fluid_bulk_modulus > 0.0 ? "undrained" : "drained");
  if (range.softest != range.stiffest) text << ", clay of E = " << E << " Pa";
  return text.str();
}

/// Scheme and largest porosity of two digits at which the other one still gives a stiffness, if there is any.
std::string describe_remedy(double porosity_limit) {
  const double safe = std::floor(porosity_limit * 100.0 * (1.0 - 1e-9)) / 100.0;
  std::ostringstream text;
  text << "choose mori_tanaka, which is positive at every phi of undrained and drained clay";
  if (safe > 0.0) text << ", or a /water/porosity up to " << safe;
  return text.str();
}

[[noreturn]] void refuse(const Scenario& s, const ClayRange& range, double E, double S_max,
                         const material::MediumRange& medium) {
  const double porosity = s.params.water.porosity;
  std::ostringstream text;
  text << name_of(s.params.moisture.medium.scheme)
       << " gives a stiffness that is not positive definite in mode \"" << medium.mode
       << "\" from phi = " << medium.phi_not_positive_definite << " on (" << describe_clay(s, range, E)
       << "), and ";
  if (S_max == 1.0)
    text << "saturated clay reaches phi = porosity = " << porosity;
  else
    text << "the wettest clay, S = " << S_max << ", has phi = " << S_max * porosity;
  throw InputError(s.file, kScheme, text.str(), describe_remedy(medium.phi_not_positive_definite / S_max));
}

/// Status of one dry modulus up to φ = n S_max.
MediumCheck check_range(const Scenario& s, const ClayRange& range, double E, double S_max) {
  using material::MediumStatus;
  const material::Elastic clay{E, s.params.elastic.poissons_ratio};
  const double phi_max = s.params.water.porosity * S_max;
  const material::MediumRange medium =
      material::compute_medium_range(clay, s.params.moisture.medium, phi_max);
  if (medium.worst == MediumStatus::not_positive_definite) refuse(s, range, E, S_max, medium);
  std::ostringstream text;
  text << "effective medium (" << describe_clay(s, range, E) << "): ";
  if (medium.worst == MediumStatus::above_voigt)
    text << "above_voigt in mode \"" << medium.mode << "\" from phi = " << medium.phi_above_voigt
         << " on, stiffer than any mixture can be; mori_tanaka stays within the bounds";
  else
    text << "ok";
  text << "; checked for phi from 0 to " << phi_max;
  return {text.str(), medium.worst == MediumStatus::above_voigt ? s.file + ": " + text.str() : ""};
}

void require_no_locking(const Scenario& s, double nu) {
  if (!(nu > kLockingPoissonsRatio) || s.params.solid.element != solid::ElementKind::p1 || s.allow_locking ||
      s.accuracy > 0.0)
    return;
  std::ostringstream text;
  text << "Poisson's ratio reaches " << nu << ", and 4-node tets lock above " << kLockingPoissonsRatio
       << ": the body would feel too stiff";
  throw InputError(
      s.file,
      s.params.moisture.medium.fluid_bulk_modulus > 0.0 ? "/material/effective_medium/fluid_bulk_modulus_Pa"
                                                        : "/material/poissons_ratio",
      text.str(),
      "use drained water (0 Pa), /dynamics/element p1_nodal or p2, or set /dynamics/allow_locking to true");
}

}  // namespace

const std::vector<std::pair<material::Scheme, std::string>>& scheme_names() {
  using material::Scheme;
  static const std::vector<std::pair<Scheme, std::string>> kNames = {
      {Scheme::mori_tanaka, "mori_tanaka"},
      {Scheme::dilute, "dilute"},
      {Scheme::dilute_strain, "dilute_strain"},
      {Scheme::self_consistent, "self_consistent"},
      {Scheme::differential, "differential"},
      {Scheme::voigt, "voigt"},
      {Scheme::reuss, "reuss"},
      {Scheme::hs_lower, "hs_lower"},
      {Scheme::hs_upper, "hs_upper"}};
  return kNames;
}

bool needs_fields(const Scenario& s) {
  return !s.body.modulus_field.empty() || !s.body.saturation_field.empty();
}

MediumCheck check_effective_medium(const Scenario& s, const ClayRange& range) {
  const material::Moisture& m = s.params.moisture;
  double nu = s.params.elastic.poissons_ratio;
  MediumCheck check{"effective medium: not used", ""};
  if (m.law == material::MoistureLaw::effective_medium && m.softens_elasticity) {
    if (!material::is_supported(m.medium))
      throw InputError(
          s.file, kScheme,
          name_of(m.medium.scheme) + " needs an isotropic medium, but the pores are aligned spheroids",
          "choose mori_tanaka, or orientation random");
    const double S_max = can_wet(s) ? 1.0 : range.initially_wet;
    check = check_range(s, range, range.softest, S_max);
    if (range.stiffest != range.softest) {
      const MediumCheck stiffest = check_range(s, range, range.stiffest, S_max);
      check.status += "\n" + stiffest.status;
      if (check.warning.empty()) check.warning = stiffest.warning;
    }
    for (const double E : {range.softest, range.stiffest})
      nu =
          std::max(nu, compute_poissons_ratio(material::compute_effective_medium(
                           {E, s.params.elastic.poissons_ratio}, m.medium, s.params.water.porosity * S_max)));
  }
  require_no_locking(s, nu);
  return check;
}

}  // namespace argil::scenario
