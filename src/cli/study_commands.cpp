// Many runs.

#include <CLI/CLI.hpp>

#include <memory>

#include "cli/commands.h"
#include "cli/finite_number.h"
#include "study/chart.h"
#include "study/stability.h"
#include "study/sweep.h"

namespace argil::cli {
namespace {

/// What the commands of this file are given; they share it, for only one of them runs.
struct Options {
  study::StudyOptions study;
  double budget = 0.0;
  study::SweepRun sweep;
  std::string first, second;
};

}  // namespace

void add_study_commands(CLI::App& app, int& code) {
  const auto o = std::make_shared<Options>();
  const auto add_study = [o](CLI::App* command) {
    command->add_option("STUDY", o->study.study, "study (JSON)")->required();
    command->add_option("-o,--output", o->study.output, "table without suffix (default: the study's name)");
    command->add_option("--runs", o->study.cases.folder,
                        "folder of results (default: the table's name.runs)");
    command->add_option("--jobs", o->study.cases.jobs, "runs at a time")->check(CLI::Range(1, 256));
    command->add_flag("-q,--quiet", o->study.cases.quiet, "print errors only");
  };
  CLI::App* chart = app.add_subcommand("chart", "accuracy against cost over methods and settings");
  add_study(chart);
  chart
      ->add_option("--budget", o->budget,
                   "print the most accurate setting of at most so many CPU seconds a second")
      ->check(finite_number(false));
  chart->callback([o, &code] {
    code = o->budget > 0.0 ? study::chart_budget(o->study, o->budget) : study::chart(o->study);
  });

  CLI::App* stability = app.add_subcommand("stability", "where methods fail, over one or two parameters");
  add_study(stability);
  stability->add_option("--failures", o->second, "folder for the smallest scenario of each failure");
  stability->callback([o, &code] { code = study::map_stability(o->study, o->second); });

  CLI::App* sweep = app.add_subcommand("sweep", "a scenario over many settings, one process a point");
  sweep->require_subcommand(1);
  CLI::App* expand = sweep->add_subcommand("expand", "write the points of a sweep, a line each");
  expand->add_option("SWEEP", o->first, "sweep (JSON)")->required();
  expand->add_option("-o,--output", o->second, "points (.jsonl)")->required();
  expand->callback([o, &code] { code = study::expand_sweep(o->first, o->second); });
  const auto add_points = [o, sweep](const char* name, const char* about) {
    CLI::App* command = sweep->add_subcommand(name, about);
    command->add_option("POINTS", o->sweep.points, "points that expand wrote")->required();
    return command;
  };
  const auto add_block = [o](CLI::App* command) {
    command->add_option("--block", o->sweep.block, "points in a block")->check(CLI::Range(1, 1000000));
  };
  CLI::App* run_block = add_points("run", "run the points of a block that are not done yet");
  run_block->add_option("--index", o->sweep.index, "number of the block (default: SLURM_ARRAY_TASK_ID)");
  add_block(run_block);
  run_block->callback([o, &code] { code = study::run_sweep(o->sweep); });
  CLI::App* missing =
      add_points("missing", "print the blocks that have not ended, as sbatch --array takes them");
  add_block(missing);
  missing->callback([o, &code] { code = study::print_missing(o->sweep.points, o->sweep.block); });
  CLI::App* collect = add_points("collect", "write one table of settings and figures");
  collect->add_option("-o,--output", o->second, "table without suffix")->required();
  collect->callback([o, &code] { code = study::collect_sweep(o->sweep.points, o->second); });
}

}  // namespace argil::cli
