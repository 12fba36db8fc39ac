#include "study/stability.h"

#include <cmath>
#include <cstdio>

#include "output/study_table.h"
#include "run/run.h"
#include "study/failures.h"
#include "study/stability_map.h"

namespace argil::study {
namespace {

output::StudyTable make_table(const StabilityMap& map) {
  const scenario::StabilityStudy& study = map.study();
  output::StudyTable table;
  table.columns = {{"kind", "-", "run, boundary (between two runs) or limit (of theory)"},
                   {"x", "1", study.x.name},
                   {"y", "1", study.y.name.empty() ? "none" : study.y.name},
                   {"x_below", "1", "boundary: last place on its lower side"},
                   {"x_above", "1", "boundary: first place on its upper side"},
                   {"outcome", "-", "what became of the run; boundary: below > above; limit: its name"},
                   {"force_error", "1", "relative L2 error of the hand force against the reference there"},
                   {"energy_gain", "1", "mechanical energy beyond what the hand gave, relative"},
                   {"chatter", "1", "rms of the hand force above 50 Hz over its rms"},
                   {"peak_force_N", "N", "largest hand force"},
                   {"reference_peak_force_N", "N", "the same of the reference there"},
                   {"run", "-", "name of the result in the folder of runs"},
                   {"reason", "-", "why the run ended early"}};
  for (const Place& p : map.places()) {
    const bool is_done = p.result.exit_code == run::kDone;
    const auto figure = [&](double value) { return is_done ? value : kUnknown; };
    table.rows.push_back({"run", p.x, p.y, kUnknown, kUnknown, to_string(p.outcome), p.errors.force,
                          figure(p.figures.energy_gain), figure(p.figures.chatter),
                          figure(p.figures.peak_force), p.true_peak_force, p.result.id, p.result.reason});
  }
  for (const Boundary& b : map.boundaries()) {
    const Place& below = map.places()[b.below];
    const Place& above = map.places()[b.above];
    const double middle = study.x.is_logarithmic ? std::sqrt(below.x * above.x) : 0.5 * (below.x + above.x);
    table.rows.push_back({"boundary", middle, below.y, below.x, above.x,
                          to_string(below.outcome) + " > " + to_string(above.outcome), kUnknown, kUnknown,
                          kUnknown, kUnknown, kUnknown, "", ""});
  }
  for (const scenario::MapLimit& limit : study.limits)
    for (std::size_t i = 0; i < limit.x.size(); ++i)
      table.rows.push_back({"limit", limit.x[i], limit.y.empty() ? kUnknown : limit.y[i], kUnknown, kUnknown,
                            limit.name, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, "", ""});
  std::vector<CaseResult> results;
  for (const Place& p : map.places()) results.insert(results.end(), {p.result, p.truth});
  table.provenance = describe_study(study.file, study.about, study.scenario, study.settings, results);
  table.provenance.emplace_back("reference", print_settings(study.reference));
  table.provenance.emplace_back("x", study.x.name);
  table.provenance.emplace_back("y", study.y.name);
  table.provenance.emplace_back(
      "logarithmic", std::string(study.x.is_logarithmic ? "x" : "") + (study.y.is_logarithmic ? "y" : ""));
  return table;
}

}  // namespace

int map_stability(StudyOptions options, const std::string& failures) {
  const scenario::StabilityStudy study = scenario::read_stability_study(options.study);
  name_outputs(options);
  check_outputs(options, study.scenario, {study.settings, join(study.settings, study.reference)});
  if (!options.cases.quiet)
    for (const std::string& note : study.notes) std::fprintf(stderr, "argil: note: %s\n", note.c_str());
  StabilityMap map(study, options.cases);
  map.run();
  const output::StudyTable table = make_table(map);
  output::write_csv(table, options.output + ".csv");
  output::write_hdf5(table, options.output + ".h5");
  if (!failures.empty()) write_failures(map, failures);
  if (!options.cases.quiet)
    std::printf("%s.csv: %zu runs, %zu boundaries\n", options.output.c_str(), map.places().size(),
                map.boundaries().size());
  std::vector<Outcome> outcomes;
  for (const Place& place : map.places()) outcomes.push_back(place.outcome);
  return print_accidents(options.study, outcomes);
}

}  // namespace argil::study
