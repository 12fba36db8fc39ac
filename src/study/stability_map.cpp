#include "study/stability_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/error.h"
#include "output/result_reader.h"
#include "run/run.h"

namespace argil::study {

void StabilityMap::run() {
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

Settings StabilityMap::settings_at(double x, double y, const Variation& variation) const {
  Settings settings;
  for (const scenario::Setting& setting : m_study.settings)
    if (std::find(variation.dropped.begin(), variation.dropped.end(), setting.pointer) ==
        variation.dropped.end())
      settings.push_back(setting);
  const auto put = [&](const scenario::MapAxis& axis, double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, axis.is_integer ? "%.0f" : "%.17g", value);
    for (const std::string& pointer : axis.pointers) settings.push_back({pointer, digits});
  };
  put(m_study.x, x);
  if (!m_study.y.values.empty()) put(m_study.y, y);
  return join(settings, variation.added);
}

scenario::Scenario StabilityMap::load_place(const Place& place, const Variation& variation) const {
  return run::load(make_run_options(m_study.scenario, settings_at(place.x, place.y, variation)));
}

/// With the truth of each where there is to be one.
std::vector<Place> StabilityMap::run_places(const std::vector<std::pair<double, double>>& points,
                                            const Variation& variation, bool has_truth) const {
  std::vector<Case> cases;
  for (const auto& [x, y] : points) {
    const Settings settings = settings_at(x, y, variation);
    cases.push_back({m_study.scenario, settings});
    if (has_truth) cases.push_back({m_study.scenario, join(settings, m_study.reference)});
  }
  const std::vector<CaseResult> results = run_cases(cases, m_options);
  const std::size_t stride = has_truth ? 2 : 1;
  std::vector<Place> places;
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_interrupt(m_options);
    Place& place = places.emplace_back();
    place.x = points[i].first;
    place.y = points[i].second;
    place.result = results[stride * i];
    if (has_truth) place.truth = results[stride * i + 1];
    judge(place, variation, has_truth);
  }
  return places;
}

Place StabilityMap::run_with(const Place& place, const Variation& variation, bool has_truth) const {
  return run_places({{place.x, place.y}}, variation, has_truth && !m_study.reference.empty()).front();
}

/// Where they stand in the list.
std::vector<std::size_t> StabilityMap::visit(const std::vector<std::pair<double, double>>& points) {
  std::vector<std::size_t> list;
  for (Place& place : run_places(points, {}, !m_study.reference.empty())) {
    list.push_back(m_places.size());
    m_places.push_back(std::move(place));
  }
  return list;
}

void StabilityMap::judge(Place& place, const Variation& variation, bool has_truth) const {
  std::optional<output::ResultReader> truth;
  if (!place.truth.file.empty() && place.truth.exit_code == run::kDone) {
    truth.emplace(place.truth.file);
    place.true_peak_force = compute_peak_force(truth->read_haptic());
  }
  if (place.result.exit_code == run::kDone) {
    const output::ResultReader reader(place.result.file);
    const scenario::Scenario s = load_place(place, variation);
    place.figures = compute_figures(reader, s);
    const Variation true_variation{join(variation.added, m_study.reference), variation.dropped};
    try {
      if (truth)
        place.errors = compute_errors(
            reader, *truth, {s.params.solid.element, load_place(place, true_variation).params.solid.element});
    } catch (const InputError& error) {
      place.result.reason = error.what();  // of this place alone
    }
  }
  OutcomeBounds bounds;
  bounds.wrong_above = m_study.wrong_above;
  bounds.compares = has_truth;
  place.outcome = classify(place.result, place.figures, place.errors, bounds);
  if (place.outcome == Outcome::unknown && place.result.reason.empty())
    place.result.reason = "reference: " + (place.truth.reason.empty() ? "no force" : place.truth.reason);
}

bool StabilityMap::turns(std::size_t a, std::size_t b) const {
  return is_known(m_places[a].outcome) && is_known(m_places[b].outcome) &&
         m_places[a].outcome != m_places[b].outcome;
}

/// Middle of a boundary; nothing when it is narrow enough.
std::optional<double> StabilityMap::find_middle(const Boundary& boundary) const {
  const double a = m_places[boundary.below].x;
  const double b = m_places[boundary.above].x;
  if (m_study.x.is_integer) return b - a > 1.5 ? std::optional(std::round(0.5 * (a + b))) : std::nullopt;
  const double range = m_study.x.values.back() - m_study.x.values.front();
  const bool is_narrow =
      m_study.x.is_logarithmic ? b / a - 1.0 <= m_study.bisect_to : b - a <= m_study.bisect_to * range;
  const double middle = m_study.x.is_logarithmic ? std::sqrt(a * b) : 0.5 * (a + b);
  return is_narrow || middle == a || middle == b ? std::nullopt : std::optional(middle);
}

/// One round over all boundaries; false when all are found. Where the middle is neither as the one side nor
/// as the other, there are two boundaries.
bool StabilityMap::bisect() {
  std::vector<std::optional<double>> middles;
  std::vector<std::pair<double, double>> points;
  for (const Boundary& boundary : m_boundaries) {
    middles.push_back(find_middle(boundary));
    if (middles.back()) points.emplace_back(*middles.back(), m_places[boundary.below].y);
  }
  if (points.empty()) return false;
  const std::vector<std::size_t> places = visit(points);
  std::vector<Boundary> halves;
  auto place = places.begin();
  for (std::size_t i = 0; i < m_boundaries.size(); ++i) {
    const Boundary& boundary = m_boundaries[i];
    if (!middles[i]) {
      halves.push_back(boundary);
      continue;
    }
    const std::size_t middle = *place++;
    if (turns(boundary.below, middle)) halves.push_back({boundary.below, middle});
    if (turns(middle, boundary.above)) halves.push_back({middle, boundary.above});
  }
  m_boundaries = std::move(halves);
  return true;
}

}  // namespace argil::study
