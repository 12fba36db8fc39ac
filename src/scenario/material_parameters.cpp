// The keys of the clay.

#include "scenario/medium_check.h"
#include "scenario/parameter_sections.h"

namespace argil::scenario {
namespace {

// Of clay, water and all that is stiffer, diamond (1e12 Pa) by far: ratios and products of two stay numbers.
constexpr double kLeastModulus = 1e-9;
constexpr double kLargestModulus = 1e18;

}  // namespace

void bind_material(Binder& b, sim::Params& p) {
  b.number("/material/youngs_modulus_Pa", p.elastic.youngs_modulus, between(kLeastModulus, kLargestModulus),
           "Pa", "Young's modulus E of the dry clay.")
      .required = true;
  b.number("/material/poissons_ratio", p.elastic.poissons_ratio, inside(-1, 0.5), "",
           "Poisson's ratio ν of the dry clay.")
      .required = true;
  b.number("/material/density_kg_per_m3", p.solid.density, positive(), "kg/m³", "Density of the dry clay.");
  material::Moisture& m = p.moisture;
  b.choice("/material/effective_medium/scheme", m.medium.scheme, scheme_names(),
           "Effective stiffness of clay with water (eq. 6 and relatives); `dilute` is the paper's.");
  b.number("/material/effective_medium/fluid_bulk_modulus_Pa", m.medium.fluid_bulk_modulus,
           between(0, kLargestModulus), "Pa", "K_I of the water; 0: drained, 2.2e9: undrained.");
  b.number("/material/effective_medium/fluid_shear_modulus_Pa", m.medium.fluid_shear_modulus,
           between(0, kLargestModulus), "Pa", "G_I of the water.");
  b.number("/material/effective_medium/aspect", m.medium.aspect, between(1e-4, 1e4), "",
           "Pores' length along their axis over their width; 1: spheres.");
  b.choice<material::Orientation>(
      "/material/effective_medium/orientation", m.medium.orientation,
      {{material::Orientation::random, "random"}, {material::Orientation::aligned, "aligned"}},
      "Pores' axes: random, or aligned.");
  b.vector("/material/effective_medium/axis", m.medium.axis, "",
           "Axis of aligned pores in the body at rest, any length.")
      .applies = [&m] { return m.medium.orientation == material::Orientation::aligned; };
  b.choice<material::MoistureLaw>("/material/moisture/law", m.law,
                                  {{material::MoistureLaw::effective_medium, "effective_medium"},
                                   {material::MoistureLaw::liquidity_index, "liquidity_index"},
                                   {material::MoistureLaw::table, "table"}},
                                  "How water changes stiffness and yield.");
  b.boolean("/material/moisture/softens_elasticity", m.softens_elasticity,
            "false: moduli stay dry, to tell causes apart.");
  b.choice<material::YieldLaw>(
      "/material/moisture/yield_law", m.yield_law,
      {{material::YieldLaw::constant, "constant"}, {material::YieldLaw::log_linear, "log_linear"}},
      "Yield strain against saturation: constant (the paper), or times saturated_yield_ratio^S.");
  b.number("/material/moisture/saturated_yield_ratio", m.saturated_yield_ratio, {0, 1, true, false}, "",
           "Yield strain at S = 1 over dry.");
  b.number("/material/moisture/saturated_strength_ratio", m.saturated_strength_ratio, {0, 1, true, false}, "",
           "liquidity_index: modulus and strength at the liquid limit over those at the plastic limit "
           "[Vardanega2014].");
  b.number("/material/moisture/plastic_limit_saturation", m.plastic_limit_saturation, {0, 1, false, true}, "",
           "liquidity_index: S at the plastic limit; drier clay keeps the dry values.");
  b.number("/material/moisture/liquid_limit_saturation", m.liquid_limit_saturation, positive(), "",
           "liquidity_index: S at the liquid limit, above the plastic one.");
  b.number("/material/moisture/suction_peak_ratio", m.suction_peak_ratio, {1, 100, false, false}, "",
           "Suction of slightly wet clay: modulus and strength at their peak over those without; 1: none.");
  b.number("/material/moisture/suction_peak_saturation", m.suction_peak_saturation, {0, 0.5, true, false}, "",
           "S at which suction stiffens most.");
  b.number("/material/moisture/refresh_tolerance", m.refresh_tolerance, between(0, 1), "",
           "Change of S beyond which a tet's moduli are looked up again.");
  const auto table_only = [&m] { return m.law == material::MoistureLaw::table; };
  b.numbers("/material/moisture/table_saturation", m.table_saturation, between(0, 1), "",
            "table: increasing, from 0 to 1.")
      .applies = table_only;
  b.numbers("/material/moisture/table_youngs_modulus_Pa", m.table_youngs_modulus,
            between(kLeastModulus, kLargestModulus), "Pa", "table: Young's modulus at each.")
      .applies = table_only;
  b.numbers("/material/moisture/table_yield", m.table_yield, not_negative(), "",
            "table: yield strain at each.")
      .applies = table_only;
  material::Plasticity& y = p.plasticity;
  b.boolean("/material/plasticity/enabled", y.enabled, "Plastic flow.");
  b.number("/material/plasticity/yield", y.yield, not_negative(), "",
           "Elastic strain norm at which flow starts.");
  b.number("/material/plasticity/strength_Pa", y.strength, not_negative(), "Pa",
           "c_u, undrained shear strength of dry clay (von Mises; √3 c_u in tension), in the place of yield; "
           "0: by yield. Water lowers it as it does modulus times yield strain. Where form is "
           "not given it is j2 then.");
  b.number("/material/plasticity/creep_per_s", y.creep_per_s, not_negative(), "1/s",
           "Rate at which the elastic strain flows away.");
  b.number("/material/plasticity/max", y.max, not_negative(), "",
           "Largest plastic strain norm; 0: none. The small-strain laws turn inside out near 1.2.");
  b.boolean("/material/plasticity/deviatoric", y.deviatoric,
            "Flow keeps the volume, and only the deviator yields.");
  b.choice<material::FlowForm>("/material/plasticity/form", y.form,
                               {{material::FlowForm::rate, "rate"},
                                {material::FlowForm::rate_to_yield, "rate_to_yield"},
                                {material::FlowForm::literal, "literal"},
                                {material::FlowForm::j2, "j2"}},
                               "Flow of 1 − e^{−c h} of the elastic strain, whose last step may pass the "
                               "yield norm; the same no further than to it, whatever the step; the literal "
                               "c h; or j2: radial return to the yield norm, rate independent.");
  b.number("/material/plasticity/rate_growth_per_decade", y.rate_growth, between(0, 10), "",
           "j2: by how much of itself the strength rises with every tenfold shear strain rate above "
           "reference_rate_per_s; clays: 0.05 to 0.2. 0: rate independent.");
  b.number("/material/plasticity/reference_rate_per_s", y.reference_rate, positive(), "1/s",
           "j2: shear strain rate at which the strength was measured; below it, it is the same.");
  b.choice<material::StrainNorm>(
      "/material/plasticity/norm", y.norm,
      {{material::StrainNorm::frobenius, "frobenius"}, {material::StrainNorm::voigt6, "voigt6"}},
      "Norm of strain; voigt6 depends on the axes.");
  material::ClayKernel& k = p.kernel;
  b.choice<material::KernelForm>(
      "/material/clay_kernel/form", k.form,
      {{material::KernelForm::rate, "rate"},
       {material::KernelForm::per_step, "per_step"},
       {material::KernelForm::off, "off"}},
      "G_d^{h/h_ref} (step independent), G_d a step (the paper), or none; eq. 9. Where it is not given: rate "
      "if one of its constants is.");
  b.number("/material/clay_kernel/k1_per_m", k.k1, not_negative(), "1/m", "k₁ of eq. 9.");
  b.number("/material/clay_kernel/k2_per_m", k.k2, not_negative(), "1/m", "k₂ of eq. 9.");
  b.number("/material/clay_kernel/radius_m", k.radius, not_negative(), "m",
           "R_D of eq. 9: radius of influence.");
  b.number("/material/clay_kernel/reference_step_s", k.reference_step, positive(), "s",
           "h_ref: step at which one G_d is applied.");
}

}  // namespace argil::scenario
