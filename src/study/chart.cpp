#include "study/chart.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "base/error.h"
#include "output/study_table.h"
#include "run/run.h"
#include "scenario/patch.h"
#include "scenario/scenario_text.h"
#include "scenario/study_file.h"
#include "study/measure.h"
#include "study/outcome.h"

namespace argil::study {
namespace {

/// One row to be: which curve, what it adds to the scenario, and what came out.
struct Row {
  std::string curve;
  Settings settings;  // on top of the study's own
  Settings point;     // of these, what sets it apart on its curve
  CaseResult result;
  Outcome outcome = Outcome::killed;
  RunFigures figures;
  RunErrors errors;
  double cost() const {
    return figures.simulated_seconds > 0.0 ? compute_median_cpu(result) / figures.simulated_seconds
                                           : kUnknown;
  }
};

constexpr std::size_t kReference = 0;  // places in the list of rows
constexpr std::size_t kRefined = 1;

std::vector<Row> list_rows(const scenario::ChartStudy& study) {
  std::vector<Row> rows(2);
  rows[kReference] = {scenario::kReferenceName, study.reference, {}, {}, {}, {}, {}};
  rows[kRefined] = {scenario::kRefinedName, join(study.reference, study.refined), {}, {}, {}, {}, {}};
  for (const scenario::Curve& curve : study.curves)
    for (const Settings& point : curve.points)
      rows.push_back({curve.name, join(curve.settings, point), point, {}, {}, {}, {}});
  return rows;
}

/// What cannot be compared is a row of the table, too.
void compare(Row& row, const output::ResultReader& run, const output::ResultReader& truth,
             const ComparedElements& elements) {
  try {
    row.errors = compute_errors(run, truth, elements);
  } catch (const InputError& error) {
    row.result.reason = error.what();
  }
}

/// What a result was made of: a run to an accuracy has another element and other cells than were asked for.
scenario::Scenario load_scene_of(const output::ResultReader& reader, const std::string& scenario,
                                 const Settings& settings) {
  if (!reader.find_accuracy()) return run::load(make_run_options(scenario, settings));
  return scenario::load_text(reader.find_provenance("scenario").value(), scenario, {});
}

std::vector<Row> run_rows(const scenario::ChartStudy& study, const CaseOptions& options) {
  std::vector<Row> rows = list_rows(study);
  std::vector<Case> cases;
  for (std::size_t i = 0; i < rows.size(); ++i)
    cases.push_back(
        {study.scenario, join(study.settings, rows[i].settings), i > kRefined ? study.repeats : 1});
  std::vector<CaseResult> results = run_cases({cases.begin(), cases.begin() + 2}, options);
  if (results[kReference].id == results[kRefined].id && !results[kReference].id.empty())
    throw InputError(study.file, "/refined", "makes the same run as /reference",
                     "refine mesh, step or tolerance, so that the reference's own error is known");
  if (results[kReference].exit_code != run::kDone) cases.resize(2);  // nothing to compare with
  rows.resize(cases.size());
  results = run_cases(cases, options);
  std::optional<output::ResultReader> truth, refined;
  if (results[kReference].exit_code == run::kDone) truth.emplace(results[kReference].file);
  if (results[kRefined].exit_code == run::kDone) refined.emplace(results[kRefined].file);
  std::vector<scenario::Scenario> scenes(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!results[i].file.empty() && results[i].exit_code <= 128)
      scenes[i] = load_scene_of(output::ResultReader(results[i].file), study.scenario, cases[i].settings);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    check_interrupt(options);
    Row& row = rows[i];
    row.result = results[i];
    if (!row.result.file.empty() && row.result.exit_code <= 128) {
      const output::ResultReader reader(row.result.file);
      row.figures = compute_figures(reader, scenes[i]);
      const std::size_t other = i == kReference ? kRefined : kReference;  // its own error: to the finer one
      const auto& other_reader = i == kReference ? refined : truth;
      if (row.result.exit_code == run::kDone && i != kRefined && other_reader)
        compare(row, reader, *other_reader,
                {scenes[i].params.solid.element, scenes[other].params.solid.element});
    }
    OutcomeBounds bounds;
    bounds.compares = i != kRefined;
    row.outcome = classify(row.result, row.figures, row.errors, bounds);
    if (row.outcome == Outcome::unknown && row.result.reason.empty())
      row.result.reason = "reference: no force";
  }
  return rows;
}

output::StudyTable make_table(const scenario::ChartStudy& study, const std::vector<Row>& rows) {
  output::StudyTable table;
  table.columns = {
      {"curve", "-", "method"},
      {"point", "-", "what sets the run apart on its curve"},
      {"outcome", "-", "what became of the run"},
      {"force_error", "1", "relative L2 error of the hand force; of the reference: against the refined one"},
      {"peak_force_error", "1", "of the largest force"},
      {"above_7_percent", "1", "share of the ticks in touch whose force errs by more than 7 %"},
      {"above_10_percent", "1", "the same for 10 %: the just noticeable difference is 7 to 10 %"},
      {"displacement_error", "1", "relative L2 over the body and all frames"},
      {"skin_error", "1", "relative L2 over the skin's vertices and all frames"},
      {"saturation_error", "1", "relative L2 over the body and all frames"},
      {"dissipation_error", "1", "of the plastic dissipation"},
      {"cpu_s_per_s", "1",
       "CPU seconds a simulated second, one thread, of all passes, median of the repeats"},
      {"simulated_s", "s", "simulated time"},
      {"steps", "1", "physics steps"},
      {"linearisations", "1", "systems of equations solved"},
      {"iterations", "1", "of the linear solver"},
      {"factorisations", "1", "of its matrix"},
      {"instructions", "1", "in user mode, of the ticks; empty: not counted on this machine"},
      {"peak_memory_MiB", "MiB", "of the process; this and all costs are empty where none ran"},
      {"peak_force_N", "N", "largest hand force"},
      {"energy_gain", "1", "mechanical energy beyond what the hand gave, relative"},
      {"chatter", "1", "rms of the hand force above 50 Hz over its rms"},
      {"settings", "-", "on top of the study's own"},
      {"run", "-", "name of the result in the folder of runs"},
      {"reason", "-", "why the run ended early"},
  };
  for (const Row& row : rows) {
    const RunErrors& e = row.errors;
    const RunFigures& f = row.figures;
    const bool has_run = row.result.exit_code == run::kDone || row.result.exit_code == run::kRunFailed;
    const auto figure = [has_run](double value) { return has_run ? value : kUnknown; };
    const auto counted = [](double value) { return value > 0.0 ? value : kUnknown; };
    table.rows.push_back({row.curve,
                          print_settings(row.point),
                          to_string(row.outcome),
                          e.force,
                          e.peak_force,
                          e.above_7_percent,
                          e.above_10_percent,
                          e.displacement,
                          e.skin,
                          e.saturation,
                          e.dissipation,
                          figure(row.cost()),
                          figure(f.simulated_seconds),
                          figure(f.steps),
                          figure(f.solves),
                          figure(f.iterations),
                          figure(f.factorisations),
                          counted(row.result.instructions),
                          counted(row.result.peak_memory_MiB),
                          figure(f.peak_force),
                          figure(f.energy_gain),
                          figure(f.chatter),
                          print_settings(row.settings),
                          row.result.id,
                          row.result.reason});
  }
  std::vector<CaseResult> results;
  for (const Row& row : rows) results.push_back(row.result);
  table.provenance = describe_study(study.file, study.about, study.scenario, study.settings, results);
  return table;
}

int print_reference_failure(const Row& row) {
  std::fprintf(stderr, "argil: the %s run did not end well: %s\n", row.curve.c_str(),
               row.result.reason.c_str());
  return run::kRunFailed;
}

/// Runs the study and writes its table; the rows.
std::vector<Row> make_chart(const scenario::ChartStudy& study, StudyOptions& options) {
  name_outputs(options);
  std::vector<Settings> all;
  for (const Row& row : list_rows(study)) all.push_back(join(study.settings, row.settings));
  check_outputs(options, study.scenario, all);
  const std::vector<Row> rows = run_rows(study, options.cases);
  const output::StudyTable table = make_table(study, rows);
  output::write_csv(table, options.output + ".csv");
  output::write_hdf5(table, options.output + ".h5");
  return rows;
}

/// The most accurate run within the budget. Errors below the reference's own cannot be told apart: of those,
/// the cheapest.
const Row* find_best(const std::vector<Row>& rows, double budget, double own_error) {
  const Row* best = nullptr;
  const auto error = [&](const Row& row) { return std::max(row.errors.force, own_error); };
  for (std::size_t i = kRefined + 1; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (!is_stable(row.outcome) || !(row.cost() <= budget)) continue;
    if (!best || std::pair(error(row), row.cost()) < std::pair(error(*best), best->cost())) best = &row;
  }
  return best;
}

}  // namespace

int chart(StudyOptions options) {
  const scenario::ChartStudy study = scenario::read_chart_study(options.study);
  const std::vector<Row> rows = make_chart(study, options);
  for (const std::size_t i : {kReference, kRefined})
    if (rows[i].result.exit_code != run::kDone) return print_reference_failure(rows[i]);
  if (!options.cases.quiet)
    std::printf("%s.csv: %zu runs, the reference's own force error %.2g\n", options.output.c_str(),
                rows.size(), rows[kReference].errors.force);
  std::vector<Outcome> outcomes;
  for (std::size_t i = kRefined + 1; i < rows.size(); ++i) outcomes.push_back(rows[i].outcome);
  return print_accidents(options.study, outcomes);
}

int chart_budget(StudyOptions options, double budget) {
  const scenario::ChartStudy study = scenario::read_chart_study(options.study);
  const std::vector<Row> rows = make_chart(study, options);
  if (rows[kReference].result.exit_code != run::kDone) return print_reference_failure(rows[kReference]);
  const double own_error = rows[kReference].errors.force;
  const Row* best = find_best(rows, budget, own_error);
  if (!best) {
    std::fprintf(stderr, "argil: no run of %s costs at most %g CPU seconds a second\n", study.file.c_str(),
                 budget);
    return run::kRunFailed;
  }
  std::fprintf(stderr, "argil: %s %s: force error %.2g at %.2g CPU seconds a second\n", best->curve.c_str(),
               print_settings(best->point).c_str(), best->errors.force, best->cost());
  if (best->errors.force <= own_error)
    std::fprintf(stderr, "argil: that is within the reference's own error of %.2g: the cheapest such run\n",
                 own_error);
  std::fputs(scenario::print_patch(join(study.settings, best->settings)).c_str(), stdout);
  return run::kDone;
}

}  // namespace argil::study
