// Command line → command → exit code.

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <iterator>

#include "base/error.h"
#include "contact/queries.h"
#include "embed/cage.h"
#include "mesh/quality.h"
#include "mesh/readers.h"
#include "output/compare.h"
#include "output/info.h"
#include "scenario/build.h"
#include "scenario/probe.h"
#include "scenario/tolerance_file.h"
#include "study/chart.h"
#include "study/export.h"
#include "study/files.h"
#include "study/identity.h"
#include "study/run.h"
#include "study/stability.h"
#include "study/sweep.h"

namespace {

using namespace argil;
using study::ExitCode;

int make_cage_file(const std::string& surface, const std::string& output, int target_tets, double scale) {
  study::require_input_file(surface);
  study::check_cage_name(surface, output);
  const embed::Cage cage = embed::make_cage(mesh::read_triangle_mesh(surface, scale), {target_tets}, surface);
  mesh::write_gmsh(cage.mesh, output);
  const embed::CageReport& r = cage.report;
  std::printf("%s: %d tets, %d vertices, cell %.4g m, boundary %.4g m off the surface, ", output.c_str(),
              r.num_tets, cage.mesh.num_vertices(), r.cell_size, r.offset);
  std::printf("dihedral angles %.2f to %.2f degrees, %d surface vertices enclosed\n", r.min_dihedral_degrees,
              r.max_dihedral_degrees, r.enclosed_vertices);
  return ExitCode::kDone;
}

int compare_files(const std::string& a, const std::string& b, const std::string& tolerances) {
  for (const std::string& file : {a, b}) study::require_input_file(file);
  output::CompareOptions options;
  if (!tolerances.empty()) {
    study::require_input_file(tolerances);
    options = scenario::load_tolerances(tolerances);
  }
  const output::CompareReport report = output::compare_results(a, b, options);
  std::fputs(to_string(report).c_str(), stdout);
  return report.is_equal() ? ExitCode::kDone : ExitCode::kDifferent;
}

int print_times_of_impact(const std::string& kind, const std::string& queries, double separation) {
  const auto pair = kind == "vertex-face" ? contact::PairKind::vertex_face : contact::PairKind::edge_edge;
  study::require_input_file(queries);
  const contact::QueryFile file = contact::read_queries(queries);
  std::puts("query,hit,time_of_impact");
  for (std::size_t q = 0; q < file.paths.size(); ++q) {
    if (const auto time = contact::find_time_of_impact(pair, file.paths[q], separation))
      std::printf("%zu,1,%.17g\n", q, *time);
    else
      std::printf("%zu,0,\n", q);
  }
  return ExitCode::kDone;
}

int print_info(const std::string& file) {
  study::require_input_file(file);
  std::cout << output::describe_result(file);
  return ExitCode::kDone;
}

int validate(const study::RunOptions& options) {
  const scenario::Scenario s = study::load(options);
  for (const std::string& warning : s.warnings) std::fprintf(stderr, "argil: warning: %s\n", warning.c_str());
  std::printf("%s: valid\n", s.file.c_str());
  return ExitCode::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Deterministic simulator of porous, deformable clay touched by a haptic tool", "argil");
  app.set_version_flag("--version", study::describe_build());
  app.require_subcommand(1);
  int code = ExitCode::kDone;

  study::RunOptions options;
  const auto add_scenario = [&](CLI::App* command) {
    command->add_option("SCENARIO", options.scenario, "scenario (JSON)")->required();
    command
        ->add_option("--set", options.settings,
                     "/json/pointer=value, put in the scenario's place; may be repeated")
        ->allow_extra_args(false);
    command->add_option("--trace", options.trace, "recorded motion in place of the scenario's");
  };
  CLI::App* run = app.add_subcommand("run", "run a scenario and write its result");
  add_scenario(run);
  run->add_option("-o,--output", options.output, "result file (default: the scenario's name with .h5)");
  run->add_option("--threads", options.threads, "threads; results do not depend on them")
      ->check(CLI::Range(1, 256));
  run->add_flag("--resume", options.resume, "go on from the result's last checkpoint, if there is one");
  run->add_flag("--dry-run", options.dry_run, "check and build everything, write nothing");
  run->add_flag("-q,--quiet", options.quiet, "print errors only");
  run->callback([&] { code = study::run(options); });

  CLI::App* check = app.add_subcommand("validate", "check a scenario without running it");
  add_scenario(check);
  check->callback([&] { code = validate(options); });

  CLI::App* show = app.add_subcommand("show", "print a scenario with every default written out");
  add_scenario(show);
  show->callback([&] { std::cout << scenario::print_resolved(study::load(options)); });

  bool reference = false;
  CLI::App* schema = app.add_subcommand("schema", "print the JSON Schema of a scenario");
  schema->add_flag("--reference", reference, "print the reference page (Markdown) instead");
  schema->callback(
      [&] { std::cout << (reference ? scenario::print_reference() : scenario::print_schema()); });

  std::string first, second;
  CLI::App* info = app.add_subcommand("info", "describe a result file");
  info->add_option("FILE", first, "result file")->required();
  info->callback([&] { code = print_info(first); });

  study::ExportOptions exported;
  CLI::App* exporting = app.add_subcommand("export", "write a result for a browser");
  exporting->add_option("FILE", exported.result, "result file")->required();
  exporting->add_option("--html", exported.html, "one page that shows the result without a network")
      ->required();
  exporting
      ->add_option("--megabytes", exported.megabytes,
                   "for the page's frames before compression; fewer are shown")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  exporting->add_flag("--cage", exported.cage, "show the cage also where there is a skin");
  exporting->callback([&] { code = study::export_result(exported); });

  CLI::App* compare =
      app.add_subcommand("compare", "compare two result files bit by bit, or within tolerances");
  compare->add_option("A", first, "result file")->required();
  compare->add_option("B", second, "result file")->required();
  std::string tolerances;
  compare->add_option("--tolerances", tolerances, "tolerances of datasets (JSON)");
  compare->callback([&] { code = compare_files(first, second, tolerances); });

  CLI::App* probe = app.add_subcommand("probe", "one law at a point: JSON on standard input and output");
  probe->add_option("KERNEL", first, "the law; src/scenario/README.md lists them")->required();
  probe->callback([&] {
    const std::string text((std::istreambuf_iterator<char>(std::cin)), std::istreambuf_iterator<char>());
    std::cout << scenario::run_probe(first, text);
  });

  CLI::App* ccd =
      app.add_subcommand("ccd", "time of impact of each query of a file, by the simulation's own detection");
  ccd->add_option("--kind", second, "vertex-face or edge-edge")
      ->required()
      ->check(CLI::IsMember({"vertex-face", "edge-edge"}));
  ccd->add_option("QUERIES", first, "CSV, eight rows of rational coordinates a query")->required();
  double separation = 0.0;
  ccd->add_option("--minimum-separation", separation, "report pairs that come this near, in the file's unit")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  ccd->callback([&] { code = print_times_of_impact(second, first, separation); });

  int target_tets = embed::CageOptions().target_tets;
  double scale = 1.0;
  CLI::App* cage = app.add_subcommand("cage", "make a tetrahedral cage that encloses a surface");
  cage->add_option("SURFACE", first, "OBJ, STL or PLY, clean or not")->required();
  cage->add_option("-o,--output", second, "cage (Gmsh, .msh)")->required();
  cage->add_option("--tets", target_tets, "wanted number of tets")->check(CLI::Range(100, 5000000));
  cage->add_option("--scale", scale, "metres per unit of the file")->check(CLI::PositiveNumber);
  cage->callback([&] { code = make_cage_file(first, second, target_tets, scale); });

  study::StudyOptions study_options;
  const auto add_study = [&](CLI::App* command) {
    command->add_option("STUDY", study_options.study, "study (JSON)")->required();
    command->add_option("-o,--output", study_options.output,
                        "table without suffix (default: the study's name)");
    command->add_option("--runs", study_options.cases.folder,
                        "folder of results (default: the table's name.runs)");
    command->add_option("--jobs", study_options.cases.jobs, "runs at a time")->check(CLI::Range(1, 256));
    command->add_flag("-q,--quiet", study_options.cases.quiet, "print errors only");
  };
  double budget = 0.0;
  CLI::App* chart = app.add_subcommand("chart", "accuracy against cost over methods and settings");
  add_study(chart);
  chart
      ->add_option("--budget", budget,
                   "print the most accurate setting of at most so many CPU seconds a second")
      ->check(CLI::PositiveNumber);
  chart->callback([&] {
    code = budget > 0.0 ? study::chart_budget(study_options, budget) : study::chart(study_options);
  });

  CLI::App* stability = app.add_subcommand("stability", "where methods fail, over one or two parameters");
  add_study(stability);
  stability->add_option("--failures", second, "folder for the smallest scenario of each failure");
  stability->callback([&] { code = study::map_stability(study_options, second); });

  study::SweepRun sweep_run;
  CLI::App* sweep = app.add_subcommand("sweep", "a scenario over many settings, one process a point");
  sweep->require_subcommand(1);
  CLI::App* expand = sweep->add_subcommand("expand", "write the points of a sweep, a line each");
  expand->add_option("SWEEP", first, "sweep (JSON)")->required();
  expand->add_option("-o,--output", second, "points (.jsonl)")->required();
  expand->callback([&] { code = study::expand_sweep(first, second); });
  const auto add_points = [&](const char* name, const char* about) {
    CLI::App* command = sweep->add_subcommand(name, about);
    command->add_option("POINTS", sweep_run.points, "points that expand wrote")->required();
    return command;
  };
  const auto add_block = [&](CLI::App* command) {
    command->add_option("--block", sweep_run.block, "points in a block")->check(CLI::Range(1, 1000000));
  };
  CLI::App* run_block = add_points("run", "run the points of a block that are not done yet");
  run_block->add_option("--index", sweep_run.index, "number of the block (default: SLURM_ARRAY_TASK_ID)");
  add_block(run_block);
  run_block->callback([&] { code = study::run_sweep(sweep_run); });
  CLI::App* missing =
      add_points("missing", "print the blocks that have not ended, as sbatch --array takes them");
  add_block(missing);
  missing->callback([&] { code = study::print_missing(sweep_run.points, sweep_run.block); });
  CLI::App* collect = add_points("collect", "write one table of settings and figures");
  collect->add_option("-o,--output", second, "table without suffix")->required();
  collect->callback([&] { code = study::collect_sweep(sweep_run.points, second); });

  try {
    app.parse(argc, argv);
    return code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kInputRefused;
  } catch (const InputError& error) {
    std::fprintf(stderr, "argil: %s\n", error.what());
    return ExitCode::kInputRefused;
  } catch (const IoError& error) {
    std::fprintf(stderr, "argil: %s\n", error.what());
    return ExitCode::kIoFailed;
  }
}
