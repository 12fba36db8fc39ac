#include "study/failures.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "output/result_reader.h"
#include "run/run.h"

namespace argil::study {
namespace {

constexpr int kMostRuns = 48;             // of a failure, to make it small; with their references
constexpr double kFewestTets = 100.0;     // that a shape is made of
constexpr double kLeastChatter = 0.1;     // [s] five periods of the slowest that counts as chatter
constexpr double kClear = 1.1;            // of its bound, that another machine's digits may see it, too
constexpr double kLeastForceShare = 0.5;  // of the first force: a touch that begins is another failure
constexpr const char* kDuration = "/trace/duration_s";
constexpr const char* kTets = "/body/shape/target_tets";

/// How far a run that reached its end is beyond what is still good: over the bound that it broke.
double compute_excess(const Place& place, const scenario::StabilityStudy& study) {
  const OutcomeBounds bounds;
  switch (place.outcome) {
    case Outcome::wrong:
      return place.errors.force / study.wrong_above;
    case Outcome::chatter:
      return place.figures.chatter / bounds.chatter_above;
    case Outcome::growing_energy:
      return place.figures.energy_gain / bounds.growing_above;
    default:
      return kClear;
  }
}

/// Steps that a run took times tets.
double compute_work(const Place& place) {
  const output::ResultReader reader(place.result.file);
  return static_cast<double>(reader.read_physics().size()) *
         static_cast<double>(reader.read_header().tets.cols());
}

/// The failure of a map's place, made smaller and smaller.
class Shrinking {
 public:
  Shrinking(const StabilityMap& map, const Place& place) : m_map(map), m_first(place), m_place(place) {
    m_work = compute_work(place);
  }

  /// Each way in turn for as long as it keeps the failure, and all again until none does.
  void shrink() {
    std::vector<std::string> settings;
    for (const scenario::Setting& setting : m_map.study().settings)
      if (setting.pointer != kDuration && setting.pointer != kTets) settings.push_back(setting.pointer);
    for (bool is_smaller = true; is_smaller;) {
      is_smaller = false;
      while (shorten()) is_smaller = true;
      while (coarsen()) is_smaller = true;
      for (const std::string& pointer : settings) is_smaller = drop(pointer) || is_smaller;
    }
  }

  scenario::Scenario make_scenario() const {
    scenario::Scenario s = m_map.load_place(m_place, m_variation);
    if (const auto failure = output::ResultReader(m_place.result.file).read_failure())
      s.trace.duration = static_cast<double>(failure->tick) * s.params.rates.haptic_period;
    return s;
  }
  const Place& place() const { return m_place; }

 private:
  bool reached_end() const { return m_place.result.exit_code == run::kDone; }

  /// A run that ends early is cut off there anyway.
  bool shorten() {
    if (!reached_end()) return false;
    const double least = m_place.outcome == Outcome::chatter ? kLeastChatter : 0.0;
    for (const double share : {0.5, 0.75, 0.875}) {
      const double seconds = share * m_place.figures.simulated_seconds;
      if (seconds >= least && add(kDuration, "%.3g", seconds)) return true;
    }
    return false;
  }

  bool coarsen() {
    const scenario::Scenario s = m_map.load_place(m_place, m_variation);
    if (s.body.kind != scenario::BodyKind::shape) return false;
    for (const double share : {0.5, 0.75})
      if (s.body.target_tets > kFewestTets &&
          add(kTets, "%.0f", std::max(kFewestTets, share * s.body.target_tets)))
        return true;
    return false;
  }

  bool drop(const std::string& pointer) {
    const auto& dropped = m_variation.dropped;
    if (std::find(dropped.begin(), dropped.end(), pointer) != dropped.end()) return false;
    Variation variation = m_variation;
    variation.dropped.push_back(pointer);
    return keeps_failure(variation, false);
  }

  bool add(const std::string& pointer, const char* format, double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, format, value);
    Variation variation = m_variation;
    std::erase_if(variation.added,
                  [&](const scenario::Setting& setting) { return setting.pointer == pointer; });
    variation.added.push_back({pointer, digits});
    return keeps_failure(variation, true);
  }

  /// Does it fail in the same way, in less work? Then it is so from here on.
  bool keeps_failure(const Variation& variation, bool must_be_less) {
    std::string words = print_settings(variation.added);
    for (const std::string& pointer : variation.dropped) words += " -" + pointer;
    if (m_num_runs == kMostRuns || !m_tried.insert(words).second) return false;
    ++m_num_runs;
    Place again = m_map.run_with(m_place, variation, reached_end());
    if (again.outcome != m_place.outcome || again.result.exit_code != m_place.result.exit_code) return false;
    if (!is_clear(again)) return false;
    const double work = compute_work(again);
    if (must_be_less ? !(work < m_work) : !(work <= m_work)) return false;
    m_variation = variation;
    m_place = std::move(again);
    m_work = work;
    return true;
  }

  /// As clear as a failure can be asked to be that was found next to a boundary, and under such a force.
  bool is_clear(const Place& again) const {
    if (!(compute_excess(again, m_map.study()) >= std::min(kClear, compute_excess(m_first, m_map.study()))))
      return false;
    if (again.outcome != Outcome::wrong && again.outcome != Outcome::chatter) return true;
    return again.figures.peak_force >= kLeastForceShare * m_first.figures.peak_force;
  }

  const StabilityMap& m_map;
  const Place& m_first;
  Place m_place;
  Variation m_variation;
  double m_work = 0.0;
  int m_num_runs = 0;
  std::set<std::string> m_tried;  // variations that ran
};

std::string describe(const StabilityMap& map, const Place& place) {
  std::ostringstream text;
  text << "Ends as " << to_string(place.outcome) << " by design of "
       << std::filesystem::path(map.study().file).filename().string();
  if (place.outcome == Outcome::wrong)
    text << ": the hand force is off by " << std::setprecision(3) << place.errors.force
         << " from that of the same with " << print_settings(map.study().reference);
  else if (!place.result.reason.empty())
    text << ": " << place.result.reason;
  return text.str();
}

void write_text(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw IoError(file, "could not be written");
}

void write_failure(const StabilityMap& map, const Place& place, const std::string& file) {
  Shrinking small(map, place);
  small.shrink();
  scenario::Scenario s = small.make_scenario();
  s.about = describe(map, small.place());
  s.file = file;
  write_text(file, scenario::print_portable(s));
}

void write_refused(const StabilityMap& map, const Place& refused, const Place& accepted,
                   const std::string& file) {
  scenario::Scenario s = map.load_place(accepted, {});
  s.about = describe(map, refused);
  s.file = file;
  write_text(file, scenario::print_portable(s, map.settings_at(refused.x, refused.y)));
}

}  // namespace

void write_failures(const StabilityMap& map, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder, "cannot be made (" + error.message() + ")");
  std::map<Outcome, const Place*> nearest;
  const auto add = [&nearest](const Place& place) {
    if (is_known(place.outcome) && place.outcome != Outcome::accurate) nearest.emplace(place.outcome, &place);
  };
  const Place* accepted = nullptr;
  for (const Boundary& b : map.boundaries())
    for (const std::size_t i : {b.below, b.above}) add(map.places()[i]);
  for (const Place& place : map.places()) {
    add(place);
    if (place.outcome != Outcome::refused && is_known(place.outcome)) accepted = &place;
  }
  const std::string stem = std::filesystem::path(map.study().file).stem().string();
  for (const auto& [outcome, place] : nearest) {
    const std::string file = folder + "/" + stem + "_" + to_string(outcome) + ".json";
    if (outcome != Outcome::refused)
      write_failure(map, *place, file);
    else if (accepted != nullptr)
      write_refused(map, *place, *accepted, file);
  }
}

}  // namespace argil::study
