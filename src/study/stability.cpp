#include "study/stability.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/error.h"
#include "output/study_table.h"
#include "scenario/study_file.h"
#include "study/measure.h"
#include "study/outcome.h"
#include "study/run.h"

namespace argil::study {
namespace {

/// A place on the map and what happened there.
struct Place {
  double x = 0.0;
  double y = kUnknown;
  CaseResult result;
  CaseResult truth;
  Outcome outcome = Outcome::killed;
  RunFigures figures;
  RunErrors errors;
};

/// Two places of one row of the map between which the outcome turns.
struct Boundary {
  std::size_t below;  // in the list of places
  std::size_t above;
};

class Map {
 public:
  Map(const scenario::StabilityStudy& study, const CaseOptions& options)
      : m_study(study), m_options(options) {}

  void run() {
    std::vector<std::pair<double, double>> grid;
    for (const double y : m_study.y.values.empty() ? std::vector<double>{kUnknown} : m_study.y.values)
      for (const double x : m_study.x.values) grid.emplace_back(x, y);
    const std::vector<std::size_t> places = visit(grid);
    const std::size_t width = m_study.x.values.size();
    for (std::size_t i = 0; i + 1 < places.size(); ++i)
      if ((i + 1) % width != 0 && turns(places[i], places[i + 1]))
        m_boundaries.push_back({places[i], places[i + 1]});
    while (m_study.bisect_to > 0.0 && bisect()) {
    }
  }
  const std::vector<Place>& places() const { return m_places; }
  const std::vector<Boundary>& boundaries() const { return m_boundaries; }

  Settings settings_at(double x, double y) const {
    Settings settings = m_study.settings;
    const auto put = [&](const scenario::MapAxis& axis, double value) {
      char digits[32];
      std::snprintf(digits, sizeof digits, axis.is_integer ? "%.0f" : "%.17g", value);
      for (const std::string& pointer : axis.pointers) settings.push_back({pointer, digits});
    };
    put(m_study.x, x);
    if (!m_study.y.values.empty()) put(m_study.y, y);
    return settings;
  }

 private:
  /// Is one accurate, wrong or unstable, and the other not? All ways to be unstable count as one.
  bool turns(std::size_t a, std::size_t b) const {
    if (!is_known(m_places[a].outcome) || !is_known(m_places[b].outcome)) return false;
    const auto rank = [this](std::size_t i) {
      const Outcome outcome = m_places[i].outcome;
      return is_stable(outcome) ? static_cast<int>(outcome) : -1;
    };
    return rank(a) != rank(b);
  }

  /// Runs places of the map, with the truth of each when there is one; where they stand in the list.
  std::vector<std::size_t> visit(const std::vector<std::pair<double, double>>& points) {
    std::vector<Case> cases;
    for (const auto& [x, y] : points) {
      cases.push_back({m_study.scenario, settings_at(x, y)});
      if (!m_study.reference.empty())
        cases.push_back({m_study.scenario, join(settings_at(x, y), m_study.reference)});
    }
    const std::vector<CaseResult> results = run_cases(cases, m_options);
    std::vector<std::size_t> list;
    const std::size_t stride = m_study.reference.empty() ? 1 : 2;
    for (std::size_t i = 0; i < points.size(); ++i) {
      Place place;
      place.x = points[i].first;
      place.y = points[i].second;
      place.result = results[stride * i];
      if (stride == 2) place.truth = results[stride * i + 1];
      judge(place);
      list.push_back(m_places.size());
      m_places.push_back(std::move(place));
    }
    return list;
  }

  void judge(Place& place) const {
    if (place.result.exit_code == kDone) {
      const output::ResultReader reader(place.result.file);
      place.figures = compute_figures(reader);
      if (!place.truth.file.empty() && place.truth.exit_code == kDone)
        place.errors = compute_errors(reader, output::ResultReader(place.truth.file));
    }
    OutcomeBounds bounds;
    bounds.wrong_above = m_study.wrong_above;
    bounds.compares = !m_study.reference.empty();
    place.outcome = classify(place.result, place.figures, place.errors, bounds);
    if (place.outcome == Outcome::unknown)
      place.result.reason = "reference: " + (place.truth.reason.empty() ? "no force" : place.truth.reason);
  }

  /// Middle of a boundary; nothing when it is narrow enough.
  std::optional<double> find_middle(const Boundary& boundary) const {
    const double a = m_places[boundary.below].x;
    const double b = m_places[boundary.above].x;
    if (m_study.x.is_integer) return b - a > 1.5 ? std::optional(std::round(0.5 * (a + b))) : std::nullopt;
    const double range = m_study.x.values.back() - m_study.x.values.front();
    const bool is_narrow =
        m_study.x.is_logarithmic ? b / a - 1.0 <= m_study.bisect_to : b - a <= m_study.bisect_to * range;
    if (is_narrow) return {};
    return m_study.x.is_logarithmic ? std::sqrt(a * b) : 0.5 * (a + b);
  }

  /// One round over all boundaries; false when all are found.
  bool bisect() {
    std::vector<std::pair<double, double>> middles;
    std::vector<Boundary*> halved;
    for (Boundary& boundary : m_boundaries)
      if (const auto middle = find_middle(boundary)) {
        middles.emplace_back(*middle, m_places[boundary.below].y);
        halved.push_back(&boundary);
      }
    if (middles.empty()) return false;
    const std::vector<std::size_t> places = visit(middles);
    for (std::size_t i = 0; i < places.size(); ++i)
      (turns(halved[i]->below, places[i]) ? halved[i]->above : halved[i]->below) = places[i];
    return true;
  }

  const scenario::StabilityStudy& m_study;
  const CaseOptions& m_options;
  std::vector<Place> m_places;
  std::vector<Boundary> m_boundaries;
};

output::StudyTable make_table(const scenario::StabilityStudy& study, const Map& map) {
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
                   {"run", "-", "name of the result in the folder of runs"},
                   {"reason", "-", "why the run ended early"}};
  for (const Place& p : map.places()) {
    const bool is_done = p.result.exit_code == kDone;
    const auto figure = [&](double value) { return is_done ? value : kUnknown; };
    table.rows.push_back({"run", p.x, p.y, kUnknown, kUnknown, to_string(p.outcome), p.errors.force,
                          figure(p.figures.energy_gain), figure(p.figures.chatter),
                          figure(p.figures.peak_force), p.result.id, p.result.reason});
  }
  for (const Boundary& b : map.boundaries()) {
    const Place& below = map.places()[b.below];
    const Place& above = map.places()[b.above];
    const double middle = study.x.is_logarithmic ? std::sqrt(below.x * above.x) : 0.5 * (below.x + above.x);
    table.rows.push_back({"boundary", middle, below.y, below.x, above.x,
                          to_string(below.outcome) + " > " + to_string(above.outcome), kUnknown, kUnknown,
                          kUnknown, kUnknown, "", ""});
  }
  for (const scenario::MapLimit& limit : study.limits)
    for (std::size_t i = 0; i < limit.x.size(); ++i)
      table.rows.push_back({"limit", limit.x[i], limit.y.empty() ? kUnknown : limit.y[i], kUnknown, kUnknown,
                            limit.name, kUnknown, kUnknown, kUnknown, kUnknown, "", ""});
  std::vector<CaseResult> results;
  for (const Place& p : map.places()) results.insert(results.end(), {p.result, p.truth});
  table.provenance = describe_study(study.file, study.about, study.scenario, study.settings, results);
  table.provenance.emplace_back("x", study.x.name);
  table.provenance.emplace_back("y", study.y.name);
  table.provenance.emplace_back(
      "logarithmic", std::string(study.x.is_logarithmic ? "x" : "") + (study.y.is_logarithmic ? "y" : ""));
  return table;
}

/// The scenario of a place that failed, until just after it did.
void write_failure(const scenario::StabilityStudy& study, const Map& map, const Place& place,
                   const std::string& file) {
  scenario::Scenario s = load(make_run_options(study.scenario, map.settings_at(place.x, place.y)));
  if (const auto failure = output::ResultReader(place.result.file).read_failure())
    s.trace.duration = static_cast<double>(failure->tick + 1) * s.params.rates.haptic_period;
  s.about = "Ends as " + to_string(place.outcome) + " by design of " +
            std::filesystem::path(study.file).filename().string() +
            (place.result.reason.empty() ? "" : ": " + place.result.reason);
  s.file = file;
  std::ofstream out(file);
  out << scenario::print_portable(s);
  out.close();
  if (!out) throw IoError(file, "could not be written");
}

/// Of each way to fail that left a result, the place that is nearest to a boundary, or the first found.
void write_failures(const scenario::StabilityStudy& study, const Map& map, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder, "cannot be made (" + error.message() + ")");
  std::map<Outcome, const Place*> nearest;
  const auto add = [&nearest](const Place& place) {
    if (is_known(place.outcome) && !is_stable(place.outcome) && !place.result.file.empty())
      nearest.emplace(place.outcome, &place);
  };
  for (const Boundary& b : map.boundaries())
    for (const std::size_t i : {b.below, b.above}) add(map.places()[i]);
  for (const Place& place : map.places()) add(place);
  const std::string stem = std::filesystem::path(study.file).stem().string();
  for (const auto& [outcome, place] : nearest)
    write_failure(study, map, *place, folder + "/" + stem + "_" + to_string(outcome) + ".json");
}

}  // namespace

int map_stability(StudyOptions options, const std::string& failures) {
  const scenario::StabilityStudy study = scenario::read_stability_study(options.study);
  name_outputs(options);
  Map map(study, options.cases);
  map.run();
  const output::StudyTable table = make_table(study, map);
  output::write_csv(table, options.output + ".csv");
  output::write_hdf5(table, options.output + ".h5");
  if (!failures.empty()) write_failures(study, map, failures);
  if (!options.cases.quiet)
    std::printf("%s.csv: %zu runs, %zu boundaries\n", options.output.c_str(), map.places().size(),
                map.boundaries().size());
  std::vector<Outcome> outcomes;
  for (const Place& place : map.places()) outcomes.push_back(place.outcome);
  return print_accidents(options.study, outcomes);
}

}  // namespace argil::study
