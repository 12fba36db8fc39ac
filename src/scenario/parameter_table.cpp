// Every key of a scenario, once. Checks, schema, reference page and `show` all read this table.

#include "scenario/parameter_table.h"

#include <filesystem>

#include "mesh/quality.h"
#include "scenario/binding.h"
#include "scenario/motion_table.h"
#include "scenario/parameter_sections.h"
#include "scenario/strain_models.h"

namespace argil::scenario {
namespace {

// A tick of 1 MHz, a thousand times as fast as the paper's; a hand that is let go within minutes: the ticks
// of either stay countable.
constexpr double kShortestTick = 1e-6;
constexpr double kLongestRelease = 100.0;

void bind_water_and_tool(Binder& b, Scenario& s, const std::string& folder) {
  water::WaterParams& w = s.params.water;
  b.number("/water/porosity", w.porosity, inside(0, 1), "",
           "n: volume of water at S = 1 over rest volume; φ = n S.");
  b.number("/water/density_kg_per_m3", w.density, positive(), "kg/m³", "ρ_w.");
  b.number("/water/diffusivity_m2_per_s", w.diffusivity, not_negative(), "m²/s",
           "D₀ of the saturation, D = D₀ e^{βS}.");
  b.number("/water/diffusivity_exponent", w.diffusivity_exponent, between(-20, 20), "",
           "β: how the diffusivity follows the saturation; 0: constant.");
  b.choice<water::DiffusionScheme>(
      "/water/diffusion", w.scheme,
      {{water::DiffusionScheme::explicit_euler, "explicit"},
       {water::DiffusionScheme::implicit_euler, "implicit"}},
      "Explicit in substeps, cost by the wet tets; or one implicit step, cost by "
      "all tets.");
  b.choice<water::FluxForm>(
      "/water/flux", w.flux,
      {{water::FluxForm::corrected, "corrected"}, {water::FluxForm::two_point, "two_point"}},
      "Flow between two tets: with the part of the gradient along their face, or two-point alone, which is "
      "faster and has the wrong D on most meshes.");
  b.choice<water::UptakeForm>(
      "/water/uptake", w.uptake,
      {{water::UptakeForm::flux, "flux"}, {water::UptakeForm::increment, "increment"}},
      "Through the touched area, or the paper's fixed step for every touched tet.");
  b.number("/water/wetting_flux_kg_per_m2_s", w.wetting_flux, not_negative(), "kg/(m² s)",
           "flux: given by the wet tool.");
  b.number("/water/drying_flux_kg_per_m2_s", w.drying_flux, not_negative(), "kg/(m² s)",
           "flux: taken by the dry tool.");
  b.number("/water/saturation_increment", w.saturation_increment, between(0, 1), "",
           "increment: of S a water step.");
  b.number("/water/swelling", w.swelling, between(0, 1), "",
           "Growth of the rest volume at S = 1, linear in S; 0: none.");
  b.boolean("/water/adds_mass", w.adds_mass, "The body weighs its water, too; false: the dry clay alone.");
  ToolSpec& t = s.tool;
  const auto only = [&t](ToolKind kind) { return [&t, kind] { return t.kind == kind; }; };
  b.choice<ToolKind>("/tool/shape/kind", t.kind,
                     {{ToolKind::sphere, "sphere"},
                      {ToolKind::capsule, "capsule"},
                      {ToolKind::stylus, "stylus"},
                      {ToolKind::mesh, "mesh"}},
                     "Tool's surface; the hand's point is its origin, its tip points to −z.");
  b.number("/tool/shape/radius_m", t.radius, size_range(), "m",
           "sphere, capsule: radius; stylus: at its upper end.")
      .applies = [&t] { return t.kind != ToolKind::mesh; };
  b.number("/tool/shape/tip_radius_m", t.tip_radius, size_range(), "m", "stylus: radius of the tip.")
      .applies = only(ToolKind::stylus);
  b.number("/tool/shape/length_m", t.length, size_range(), "m",
           "capsule, stylus: length of the straight part.")
      .applies = [&t] { return t.kind == ToolKind::capsule || t.kind == ToolKind::stylus; };
  b.integer("/tool/shape/subdivisions", t.subdivisions, between(0, 6),
            "sphere: times an icosahedron is split.")
      .applies = only(ToolKind::sphere);
  b.integer("/tool/shape/segments", t.segments, between(6, 256), "capsule, stylus: around the axis.")
      .applies = [&t] { return t.kind == ToolKind::capsule || t.kind == ToolKind::stylus; };
  b.path("/tool/shape/file", t.file, folder, "mesh: closed triangle surface.").applies = only(ToolKind::mesh);
  b.number("/tool/shape/scale", t.scale, size_range(), "", "mesh: metres per unit of the file.").applies =
      only(ToolKind::mesh);
  b.choice<ModeChoice>("/tool/mode", t.mode,
                       {{ModeChoice::trace, "trace"},
                        {ModeChoice::push, "push"},
                        {ModeChoice::pull, "pull"},
                        {ModeChoice::wet, "wet"},
                        {ModeChoice::dry, "dry"}},
                       "What the tool does; trace: as recorded.");
  contact::ContactParams& c = s.params.contact;
  b.choice<contact::ContactLaw>(
      "/contact/law", c.law,
      {{contact::ContactLaw::pairs, "pairs"}, {contact::ContactLaw::pressure, "pressure"}},
      "A stiffness for each pair of features in touch (the paper), or a pressure over the area in touch.");
  const auto pairs = [&c] { return c.law == contact::ContactLaw::pairs; };
  const auto pressure = [&c] { return c.law == contact::ContactLaw::pressure; };
  b.number("/contact/stiffness_Pa_per_m", c.pressure_stiffness, not_negative(), "Pa/m",
           "pressure: κ, pressure per depth; 0: chosen from the body's modulus and cells.")
      .applies = pressure;
  b.number("/contact/grip_strength_Pa", c.grip_strength, not_negative(), "Pa",
           "pressure: mean traction at which a pulling tool lets go; 0: 8 times the clay's shear strength, "
           "√2 G yield.")
      .applies = pressure;
  Parameter& vertex_face = b.number("/contact/vertex_face_stiffness_N_per_m", c.vertex_face_stiffness,
                                    positive(), "N/m", "pairs: k_vf of eq. 7, per pair.");
  vertex_face.required = true;
  vertex_face.applies = pairs;
  Parameter& edge_edge = b.number("/contact/edge_edge_stiffness_N_per_m", c.edge_edge_stiffness,
                                  not_negative(), "N/m", "pairs: k_ee of eq. 8, per pair.");
  edge_edge.required = true;
  edge_edge.applies = pairs;
  b.choice<sim::SurfaceKind>(
      "/contact/surface", s.params.contact_surface,
      {{sim::SurfaceKind::automatic, "auto"},
       {sim::SurfaceKind::cage, "cage"},
       {sim::SurfaceKind::skin, "skin"}},
      "What the tool meets: the boundary of the solid (the paper), or the skin that "
      "the eye sees; auto: by the pressure law the skin where there is one, by that of "
      "pairs the cage.");
  b.choice<contact::PenaltyKind>(
      "/contact/penalty", c.penalty,
      {{contact::PenaltyKind::continuous, "continuous"}, {contact::PenaltyKind::discrete, "discrete"}},
      "Mean depth over the motion (eqs. 7 and 8), or the depth at its end.");
  b.number("/contact/damping_s_per_m", c.damping, not_negative(), "s/m",
           "Share by which the normal force grows for each m/s of approach (Hunt and Crossley 1975).");
  b.number("/contact/friction", c.friction, between(0, 10), "",
           "Coulomb's coefficient of the tool on the body; 0: none (the paper).");
  b.number("/contact/minimum_separation_m", c.minimum_separation, not_negative(), "m",
           "Pairs that come this near count as met by detection; the force stays that of penetration.");
  b.number(
      "/contact/face_blend", c.face_blend, between(0, 10), "",
      "Faces farther from a vertex than its nearest by less than this share of the distance also turn its "
      "force; 0: the nearest alone (the paper).");
}

void bind_dynamics(Binder& b, Scenario& s) {
  solid::SolidParams& d = s.params.solid;
  b.choice<Mode>("/dynamics/mode", s.mode, {{Mode::dynamic, "dynamic"}, {Mode::equilibrium, "static"}},
                 "The hand's motion in time, or one equilibrium under /body/loads and /body/fixed, elastic, "
                 "without tool and trace.");
  b.choice("/dynamics/model", d.model, strain_model_names(),
           describe_strain_models() +
               " Where it is not given: hencky of clay whose strength is in pascals, curnier of elastic, "
               "isotropic clay in a body made here.");
  b.choice<solid::ElementKind>(
      "/dynamics/element", d.element,
      {{solid::ElementKind::p1, "p1"},
       {solid::ElementKind::p1_nodal, "p1_nodal"},
       {solid::ElementKind::p2, "p2"}},
      "4-node tets, the same without locking (volume averaged at nodes), 10-node tets.");
  b.choice<solid::Integrator>("/dynamics/integrator", d.integrator,
                              {{solid::Integrator::backward_euler, "backward_euler"},
                               {solid::Integrator::bdf2, "bdf2"},
                               {solid::Integrator::newmark, "newmark"},
                               {solid::Integrator::symplectic_euler, "symplectic_euler"}},
                              "Step in time; newmark: average acceleration; symplectic_euler: explicit.");
  b.choice<solid::Iteration>("/dynamics/iteration", d.iteration,
                             {{solid::Iteration::one, "one"}, {solid::Iteration::newton, "newton"}},
                             "One linearised solve a step, or Newton's method with line search.");
  b.number("/dynamics/newton/tolerance", d.newton_tolerance, inside(0, 1), "",
           "newton: residual over the sum of the norms of its parts.");
  b.integer("/dynamics/newton/max_iterations", d.newton_max_iterations, between(1, 1e6),
            "newton: iterations after which the run stops.");
  using linear::SolverKind;
  b.choice<SolverKind>("/dynamics/solver/kind", d.solver.kind,
                       {{SolverKind::pcg, "pcg"},
                        {SolverKind::pcg_cholesky, "pcg_cholesky"},
                        {SolverKind::pcg_jacobi, "pcg_jacobi"},
                        {SolverKind::pcg_matrix_free, "pcg_matrix_free"},
                        {SolverKind::cholesky, "cholesky"},
                        {SolverKind::supernodal, "supernodal"}},
                       "Conjugate gradients over diagonal blocks or a kept factor as the scene needs; always "
                       "a kept factor; always diagonal blocks, the same without a stored matrix; or a "
                       "factor of every new matrix, simplicial or supernodal.");
  b.number(
      "/dynamics/solver/tolerance", d.solver.tolerance, inside(0, 1), "",
      "Residual at which a step's linear solve stops, over that of a body that goes on as before or, where "
      "that is less, over the contact's force. At 1e-3 the force at the hand is off by some 1e-4 of its "
      "peak, by up to 1e-3 in steps of 5 ms and more, 6e-3 where clay flows, and 5e-3 as a fast pull turns "
      "in steps of 14 ms; at 1e-4 by a tenth of that. Newton's method and statics take at most 1e-8.");
  b.integer("/dynamics/solver/max_iterations", d.solver.max_iterations, between(1, 1e6),
            "Iterations after which the run stops.");
  b.integer(
      "/dynamics/solver/jacobi_iterations", d.solver.jacobi_iterations, between(1, 1e6),
      "pcg: a solve that takes more over diagonal blocks goes on with a kept factor, as do all later ones.");
  b.integer("/dynamics/solver/refactor_iterations", d.solver.refactor_iterations, between(1, 1e6),
            "A solve with more iterations over a kept factor has it renewed.");
  b.choice<sim::Extent>(
      "/dynamics/extent", s.params.extent,
      {{sim::Extent::automatic, "auto"}, {sim::Extent::whole, "whole"}, {sim::Extent::local, "local"}},
      "Solve for the whole body, or for the region that moves, where the rest stays as it is, with its "
      "strain, until it would move; auto: under /fidelity auto for the region in bodies of 1500 free nodes "
      "or "
      "more, where there is no friction and it can be, else for the whole.");
  b.number("/dynamics/region_tolerance", d.region_tolerance, inside(0, 1), "",
           "local: speed over the fastest node's below which nodes stay where they are.");
  b.number("/dynamics/rayleigh_mass_per_s", d.rayleigh_mass, not_negative(), "1/s", "a in D = a M + b K.");
  b.number("/dynamics/rayleigh_stiffness_s", d.rayleigh_stiffness, not_negative(), "s",
           "b in D = a M + b K.");
  b.boolean("/dynamics/implicit_contact", d.implicit_contact, "Contact stiffness enters the implicit solve.");
  b.number("/dynamics/energy_limit", s.params.energy_limit, not_negative(), "",
           "Kinetic energy over what hand, loads and supports gave the body, above which a step counts as "
           "wrong; 0: no limit.");
  b.number("/dynamics/min_volume_ratio", d.min_volume_ratio, {-1e300, 1, true, true}, "",
           "det F of a tet at or below which no step takes it.");
  b.boolean(
      "/dynamics/strict", s.params.is_strict,
      "A step that cannot be made, or a hand whose force chatters, ends the run. Else the motion of the "
      "tets concerned is limited, or the whole body is held back, or the hand is let go, and the "
      "run goes on; the result counts it.");
  b.number(
      "/dynamics/rest_speed_m_per_s", s.params.rest_speed, not_negative(), "m/s",
      "A body that nothing acts on and that is slower for two steps is stopped and not solved for; 0: only "
      "one that has not moved yet.");
  b.boolean("/dynamics/allow_locking", s.allow_locking,
            "Run nearly incompressible 4-node tets although they lock.");
}

void bind_fidelity(Binder& b, Scenario& s) {
  sim::FidelityParams& f = s.params.fidelity;
  using sim::FidelityMode;
  b.choice<FidelityMode>(
      "/fidelity/mode", f.mode,
      {{FidelityMode::full, "full"}, {FidelityMode::automatic, "auto"}, {FidelityMode::check, "check"}},
      "Compute all of the model in every step; or what the force at the hand needs; or that beside "
      "a full run of the same motion, which shows the true error.");
  b.number("/fidelity/force_tolerance", f.force_tolerance, inside(0, 1), "",
           "auto: error of the force at the hand over that force.");
  b.number("/fidelity/force_floor_N", f.force_floor, positive(), "N",
           "auto: error of the force at the hand that never counts.");
  b.number(
      "/fidelity/accuracy", s.accuracy, between(0.0, 0.5), "",
      "Wanted: root mean square error of the force at the hand while it touches, over the force's. Ten-node "
      "tets are chosen for it, small where the tool comes, by a pass or more over the motion; 0: as given.");
}

void bind_haptics(Binder& b, Scenario& s, const std::string& folder) {
  sim::RateParams& r = s.params.rates;
  b.number("/haptics/period_s", r.haptic_period, {kShortestTick, 1.0, false, true}, "s",
           "δ: one haptic tick.");
  b.integer("/haptics/physics_period_ticks", r.physics_period_ticks, between(1, 100000),
            "Physics once in so many ticks; 14 is the paper's 71 Hz.");
  b.integer("/haptics/water_period_ticks", r.water_period_ticks, between(1, 1e6),
            "Water once in so many ticks; a multiple of the physics.");
  b.integer("/haptics/frame_period_ticks", r.frame_period_ticks, between(1, 1e9),
            "A picture of the body once in so many ticks.");
  b.choice<sim::BetweenFrames>(
      "/haptics/between_frames", r.between_frames,
      {{sim::BetweenFrames::hold, "hold"},
       {sim::BetweenFrames::re_evaluate, "re_evaluate"},
       {sim::BetweenFrames::compliant, "compliant"}},
      "Keep the force between physics steps (the paper), or follow the tool: pairs find contact every "
      "tick against the surface as it was (re_evaluate) or as it yields (compliant); a "
      "pressure is carried on as the body yields, by either.");
  b.choice<device::Passivity>(
      "/haptics/passivity", s.params.passivity,
      {{device::Passivity::none, "none"}, {device::Passivity::time_domain, "time_domain"}},
      "Damp the force at the hand where it would give back more energy than the hand gave [Hannaford2002].");
  b.number("/haptics/chatter_limit", s.params.chatter_limit, {0.0, 1.0, true, false}, "",
           "The force at the hand chatters when it has trembled for 0.3 s: its rms above 50 Hz is "
           "more than this share of its rms. 1: never.");
  b.boolean("/haptics/force_error", s.params.estimates_error,
            "Estimate in every tick by how much the force is off: by mesh, step, contact, solver and what is "
            "left out.");
  device::DeviceLimits& l = s.params.device;
  b.number("/haptics/device/max_force_N", l.max_force, positive(), "N", "Largest force the device is sent.");
  b.number("/haptics/device/max_torque_Nm", l.max_torque, not_negative(), "N m",
           "Largest torque; 0: no limit.");
  b.number("/haptics/device/max_force_rate_N_per_s", l.max_force_rate, positive(), "N/s",
           "Fastest change of the force sent.");
  b.number("/haptics/device/ramp_s", l.ramp_s, not_negative(), "s", "Start-up ramp from zero.");
  device::WatchdogLimits& w = l.watchdog;
  b.number("/haptics/device/watchdog/max_sample_age_s", w.max_sample_age, positive(), "s",
           "Live: age of the device's last sample at which the hand is let go.");
  b.number("/haptics/device/watchdog/max_physics_age_s", w.max_physics_age, positive(), "s",
           "Live: age of the surface that the hand feels at which it is let go.");
  b.number("/haptics/device/watchdog/release_s", w.release_s, between(0.0, kLongestRelease), "s",
           "In which the force falls to zero then, and comes back; 0: at once.");
  bind_trace(b, s.trace, folder);
  bind_hand(b, s.hand);
  b.integer(
      "/output/checkpoint_period_ticks", s.checkpoint_period_ticks, between(0, 1e9),
      "A checkpoint for --resume at the first physics step after so many ticks; 0: none but at a signal.");
  b.choice<output::FramePrecision>(
      "/output/frame_precision", s.frame_precision,
      {{output::FramePrecision::picture, "picture"},
       {output::FramePrecision::single, "single"},
       {output::FramePrecision::whole, "double"}},
      "What frames keep of large arrays, in bits of their largest value; picture: 22 "
      "of the cage's positions, 16 of the skin's, 12 of fields, in a tenth of the "
      "room; single: 24 of fields and skin, in a quarter of the room; double: all. "
      "Series, hashes and checkpoints are always whole.");
}

}  // namespace

Range size_range() {
  return between(mesh::kSmallestSize, mesh::kLargestSize);
}

std::vector<Parameter> make_parameter_table(Scenario& s, const std::string& file) {
  Binder b(file);
  const std::string folder = std::filesystem::path(file).parent_path().string();
  b.text("/about", s.about, "Purpose, source and expected outcome.").required = true;
  Parameter& preset =
      b.choice<Preset>("/preset", s.preset, {{Preset::none, "none"}, {Preset::paper, "paper"}},
                       "Settings below the scenario's own keys; paper: the paper to the letter.");
  preset.applies = [] { return false; };  // a resolved scenario has the preset's settings written out
  bind_body(b, s.body, s.params, folder);
  bind_material(b, s.params);
  bind_water_and_tool(b, s, folder);
  bind_dynamics(b, s);
  bind_fidelity(b, s);
  bind_haptics(b, s, folder);
  std::vector<Parameter> rows = b.take();
  for (Parameter& row : rows)
    if (is_of_motion(row.pointer))
      row.applies = [&s, applies = row.applies] {
        return s.mode == Mode::dynamic && (!applies || applies());
      };
  return rows;
}

bool is_of_motion(const std::string& pointer) {
  for (const char* folder : {"/tool/", "/contact/", "/haptics/", "/trace/", "/output/"})
    if (pointer.rfind(folder, 0) == 0) return true;
  return false;
}

}  // namespace argil::scenario
