// A run, what it reads and what it wrote.

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "cli/commands.h"
#include "cli/finite_number.h"
#include "device/devices.h"
#include "live/live.h"
#include "output/compare.h"
#include "output/info.h"
#include "run/approach.h"
#include "run/export.h"
#include "run/files.h"
#include "run/new_scenario.h"
#include "run/place.h"
#include "run/plan.h"
#include "run/ready_run.h"
#include "run/run.h"
#include "run/start.h"
#include "scenario/build.h"
#include "scenario/model_summary.h"
#include "scenario/tolerance_file.h"
#include "study/figures_beside.h"

namespace argil::cli {
namespace {

using run::ExitCode;

/// What the commands of this file are given; they share it, for only one of them runs.
struct Options {
  run::RunOptions run;
  live::LiveOptions live;
  run::ExportOptions exported;
  run::PlaceOptions placed;
  run::PlanOptions planned;
  run::NewOptions made;
  std::string at = "nearest", from;
  bool reference = false;
  bool of_tolerances = false;
  bool verbose = false;
  std::vector<std::string> devices;
  std::string first, second, tolerances;
};

int compare_files(const std::string& a, const std::string& b, const std::string& tolerances, bool verbose) {
  for (const std::string& file : {a, b}) run::require_input_file(file);
  output::CompareOptions options;
  if (!tolerances.empty()) {
    run::require_input_file(tolerances);
    options = scenario::load_tolerances(tolerances);
  }
  const output::CompareReport report = output::compare_results(a, b, options);
  std::fputs(study::print_figures_beside(a, b).c_str(), stdout);
  std::fputs(to_string(report, verbose).c_str(), stdout);
  return report.is_equal() ? ExitCode::kDone : ExitCode::kDifferent;
}

/// "X,Y,Z", of an option.
Vec3 parse_place(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  Vec3 place;
  bool is_place = parts.size() == 3;
  for (Eigen::Index k = 0; is_place && k < 3; ++k)
    is_place =
        CLI::detail::lexical_cast(parts[static_cast<std::size_t>(k)], place(k)) && std::isfinite(place(k));
  if (!is_place)
    throw InputError(option, text, "is not X,Y,Z, three finite numbers", "write for instance 0,0,0.05");
  return place;
}

int place(Options& o) {
  o.placed.run = o.run;
  if (o.at != "nearest") o.placed.touch.at = parse_place("--at", o.at);
  if (!o.from.empty()) o.placed.touch.from = parse_place("--from", o.from);
  return run::place(o.placed);
}

int print_info(const std::string& file) {
  run::require_input_file(file);
  const output::ResultReader reader(file);
  std::cout << output::describe_result(reader);
  if (const auto scenario = reader.find_provenance("scenario"))
    std::cout << scenario::describe_model(*scenario, file + ": /provenance/scenario",
                                          reader.find_session().has_value());
  return ExitCode::kDone;
}

/// Without names: the kinds that there are, and those of them that can be looked for.
void print_devices(std::vector<std::string> names) {
  constexpr double kPatience = 2.0;  // [s] for each
  if (names.empty()) {
    for (const device::DeviceKind& kind : device::device_kinds()) {
      std::printf("%-12s %s\n", kind.name.c_str(), kind.about.c_str());
      if (kind.name != "plugin") names.push_back(kind.name);  // which needs a file
    }
    std::puts("");
  }
  std::fputs(device::describe_devices(names, kPatience).c_str(), stdout);
}

/// The note says what a default only gives a rule for.
void show(const run::RunOptions& options) {
  const scenario::Scenario s = run::load(options);
  std::cout << scenario::print_resolved(s) << std::flush;
  if (s.mode != scenario::Mode::dynamic || s.params.contact.law != contact::ContactLaw::pressure) return;
  const sim::BodySide body(scenario::build_scene(s).body, s.params);
  std::fprintf(stderr, "argil: note: /contact: %s\n",
               run::describe_contact_stiffness(body, s.params.contact).c_str());
}

void print_scene_notes(const scenario::Scene& scene, const std::string& miss) {
  for (const std::string& note : scene.trace.notes)
    std::fprintf(stderr, "argil: note: trace: %s\n", note.c_str());
  for (const std::string& note : scene.file_notes) std::fprintf(stderr, "argil: note: %s\n", note.c_str());
  if (!scene.free_motion.empty()) std::fprintf(stderr, "argil: note: %s\n", scene.free_motion.c_str());
  if (!scene.contact_cells.empty()) std::fprintf(stderr, "argil: note: %s\n", scene.contact_cells.c_str());
  if (!miss.empty()) std::fprintf(stderr, "argil: note: %s\n", miss.c_str());
}

/// Reads and builds what a run would, up to its first tick.
int validate(const run::RunOptions& options) {
  const scenario::Scenario s = run::load(options);
  if (s.mode == scenario::Mode::equilibrium) {
    print_scene_notes(scenario::build_scene(s), "");
  } else {
    const run::ReadyRun ready(s, options.trace);
    print_scene_notes(ready.scene, ready.miss);
  }
  for (const std::string& warning : s.warnings) std::fprintf(stderr, "argil: warning: %s\n", warning.c_str());
  std::printf("%s: valid\n", s.file.c_str());
  return ExitCode::kDone;
}

}  // namespace

void add_run_commands(CLI::App& app, int& code) {
  const auto o = std::make_shared<Options>();
  const auto add_patches = [o](CLI::App* command) {
    command
        ->add_option(
            "--patch", o->run.patches,
            "JSON file with keys of a scenario, put in the place of its own before --set; may be repeated")
        ->allow_extra_args(false);
  };
  const auto add_scenario = [o, add_patches](CLI::App* command) {
    command->add_option("SCENARIO", o->run.scenario, "scenario (JSON)")->required();
    command
        ->add_option("--set", o->run.settings,
                     "/json/pointer=value, put in the scenario's place; may be repeated")
        ->allow_extra_args(false);
    add_patches(command);
    command->add_option("--trace", o->run.trace, "recorded motion in place of the scenario's");
  };
  const auto add_strict = [o](CLI::App* command) {
    command->add_flag("--strict", o->run.strict, "a step that cannot be made ends the run (exit code 3)");
  };
  const auto add_accuracy = [o](CLI::App* command) {
    command
        ->add_option_function<double>(
            "--accuracy",
            [o](double wanted) {
              std::ostringstream text;
              text << "/fidelity/accuracy=" << wanted;
              o->run.settings.push_back(text.str());
            },
            "wanted error of the force at the hand, e.g. 0.02: cells are chosen for it (/fidelity/accuracy)")
        ->check(finite_number(false));
  };
  CLI::App* run = app.add_subcommand("run", "run a scenario and write its result");
  add_scenario(run);
  run->add_option("-o,--output", o->run.output, "result file (default: the scenario's name with .h5)");
  run->add_option("--threads", o->run.threads, "threads; results do not depend on them")
      ->check(CLI::Range(1, run::kMostThreads));
  add_accuracy(run);
  run->add_flag("--resume", o->run.resume, "go on from the result's last checkpoint, if there is one");
  run->add_flag("--dry-run", o->run.dry_run, "check and build everything, write nothing");
  add_strict(run);
  run->add_flag("-q,--quiet", o->run.quiet, "print errors only");
  run->callback([o, &code] { code = run::run(o->run); });

  CLI::App* live = app.add_subcommand("live", "run a scenario with a device in the place of its trace");
  live->add_option("SCENARIO", o->run.scenario, "scenario (JSON)")->required();
  live->add_option("--device", o->live.device, "argil devices lists them")->required();
  live->add_option("--set", o->run.settings, "as with run")->allow_extra_args(false);
  add_patches(live);
  live->add_option("-o,--output", o->run.output, "result file, which argil run --trace replays");
  live->add_option("--duration", o->live.duration, "seconds (default: a simulated hand's trace; else Ctrl-C)")
      ->check(finite_number(false));
  live->add_option("--threads", o->run.threads, "of the physics; results do not depend on them")
      ->check(CLI::Range(1, run::kMostThreads));
  live->add_option("--watch", o->live.watch, "HDF5 file that others may read while it grows (SWMR)");
  add_strict(live);
  live->add_flag("-q,--quiet", o->run.quiet, "print errors only");
  live->callback([o, &code] {
    o->live.run = o->run;
    code = live::run_live(o->live);
  });

  CLI::App* devices = app.add_subcommand("devices", "list the kinds of devices, or look for some");
  devices->add_option("NAME", o->devices,
                      "devices, as with live: is it there, and what does it say of itself");
  devices->callback([o] { print_devices(o->devices); });

  CLI::App* check = app.add_subcommand("validate", "check a scenario without running it");
  add_scenario(check);
  check->callback([o, &code] { code = validate(o->run); });

  CLI::App* show_command = app.add_subcommand("show", "print a scenario with every default written out");
  add_scenario(show_command);
  show_command->callback([o] { show(o->run); });

  CLI::App* placing = app.add_subcommand(
      "place", "say how near the tool comes, and propose where to put the motion so that it touches");
  add_scenario(placing);
  placing
      ->add_option(
          "--at", o->at,
          "X,Y,Z [m] of the body's surface, or nearest: along the line where tool and body are nearest")
      ->capture_default_str();
  placing->add_option("--from", o->from, "X,Y,Z: direction that the tool comes from, with --at X,Y,Z");
  placing
      ->add_option(
          "--depth", o->placed.touch.depth,
          "how deep the tool goes into the body at rest [m] (default: a quarter of the tool's radius)")
      ->check(finite_number(false));
  placing->add_option("-o,--output", o->placed.output, "patch for argil run --patch (default: printed)");
  placing->callback([o, &code] { code = place(*o); });

  CLI::App* planning = app.add_subcommand(
      "plan", "choose element, cells and step by a recorded motion, for a live session or a sweep");
  add_scenario(planning);
  add_accuracy(planning);
  planning->add_option("--threads", o->run.threads, "threads; what is chosen does not depend on them")
      ->check(CLI::Range(1, run::kMostThreads));
  planning->add_option("-o,--output", o->planned.output, "patch for --patch (default: printed)");
  planning->add_flag("-q,--quiet", o->run.quiet, "print errors only");
  planning->callback([o, &code] {
    o->planned.run = o->run;
    code = run::plan(o->planned);
  });

  CLI::App* making = app.add_subcommand("new", "write a short scenario of a mesh and a recorded motion");
  making->add_option("MESH", o->made.mesh, "surface (OBJ, OFF, PLY, STL) or tetrahedral mesh")->required();
  making->add_option("TRACE", o->made.trace, "recorded motion")->required();
  making->add_option("-o,--output", o->made.output, "scenario (default: the mesh's name with .json)");
  making->add_option("--tool-radius", o->made.tool_radius, "of the ball [m] (default: by the body)")
      ->check(finite_number(false));
  making->add_option("--youngs-modulus", o->made.youngs_modulus, "E of the dry clay [Pa]")
      ->check(finite_number(false))
      ->capture_default_str();
  making->add_option("--poissons-ratio", o->made.poissons_ratio, "of the dry clay")->capture_default_str();
  making->add_option("--strength", o->made.strength, "undrained shear strength of the dry clay [Pa]")
      ->check(finite_number(false))
      ->capture_default_str();
  making->add_option("--mesh-unit", o->made.mesh_unit,
                     "m, cm, mm, um, or metres per unit of the mesh (default: m, or by its size)");
  making->add_option("--trace-unit", o->made.trace_unit,
                     "m, cm, mm or um of the motion (default: as it says, else m, or by its size)");
  making->add_option("--up", o->made.up, "x, y or z: the body is held by its lowest part")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  making->add_option("--set", o->made.settings, "/json/pointer=value, a further key; may be repeated")
      ->allow_extra_args(false);
  making->add_flag("--force", o->made.overwrites, "write over a file that is there");
  making->callback([o, &code] { code = run::write_new_scenario(o->made); });

  CLI::App* schema = app.add_subcommand("schema", "print the JSON Schema of a scenario");
  schema->add_flag("--reference", o->reference, "print the reference page (Markdown) instead");
  schema->add_flag("--tolerances", o->of_tolerances, "print that of a tolerance file for compare instead");
  schema->callback([o] {
    std::cout << (o->reference       ? scenario::print_reference()
                  : o->of_tolerances ? scenario::print_tolerance_schema()
                                     : scenario::print_schema());
  });

  CLI::App* info = app.add_subcommand("info", "say how a run went, and what it made simpler than it is");
  info->add_option("FILE", o->first, "result file")->required();
  info->callback([o, &code] { code = print_info(o->first); });

  CLI::App* exporting = app.add_subcommand("export", "write a result for a browser or for VTK");
  exporting->add_option("FILE", o->exported.result, "result file")->required();
  CLI::App* forms = exporting->add_option_group("forms");
  forms->require_option(1, 2);
  forms->add_option("--html", o->exported.html, "one page that shows the result without a network");
  forms->add_option("--vtu", o->exported.vtu,
                    "series for VTK: its list (.pvd), beside a folder of .vtu files");
  exporting
      ->add_option("--megabytes", o->exported.megabytes,
                   "for the page's frames before compression; fewer are shown")
      ->check(finite_number(false))
      ->capture_default_str();
  exporting->add_flag("--cage", o->exported.cage, "show the cage also where there is a skin");
  exporting->callback([o, &code] { code = run::export_result(o->exported); });

  CLI::App* compare = app.add_subcommand(
      "compare", "compare two result files: their figures, then bit by bit or within tolerances");
  compare->add_option("A", o->first, "result file")->required();
  compare->add_option("B", o->second, "result file")->required();
  compare->add_option("--tolerances", o->tolerances, "tolerances of datasets (JSON)");
  compare->add_flag("--verbose", o->verbose, "name every difference, hashes too");
  compare->callback([o, &code] { code = compare_files(o->first, o->second, o->tolerances, o->verbose); });
}

}  // namespace argil::cli
