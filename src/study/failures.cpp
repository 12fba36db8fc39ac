#include "study/failures.h"

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>

#include "base/error.h"
#include "output/result_reader.h"
#include "study/run.h"

namespace argil::study {
namespace {

/// The failure of a map's place, made smaller and smaller.
class Shrinking {
 public:
  Shrinking(const StabilityMap& map, const Place& place) : m_map(map), m_place(place) {}

  void shrink() {
    if (m_place.result.exit_code == kDone && m_place.outcome != Outcome::wrong)
      halve("/trace/duration_s", m_place.figures.simulated_seconds, 0.0);
    const scenario::Scenario s = m_map.load_place(m_place, {});
    if (s.body.kind == scenario::BodyKind::shape)
      halve("/body/shape/target_tets", s.body.target_tets, kFewestTets);
  }

  scenario::Scenario make_scenario() const {
    scenario::Scenario s = m_map.load_place(m_place, m_extra);
    if (m_place.result.file.empty()) return s;
    if (const auto failure = output::ResultReader(m_place.result.file).read_failure())
      s.trace.duration = static_cast<double>(failure->tick + 1) * s.params.rates.haptic_period;
    return s;
  }
  const Place& place() const { return m_place; }

 private:
  static constexpr double kFewestTets = 100.0;
  static constexpr int kHalvings = 5;

  void halve(const std::string& pointer, double value, double least) {
    for (int i = 0; i < kHalvings; ++i) {
      value *= 0.5;
      if (value < least) return;
      char digits[32];
      std::snprintf(digits, sizeof digits, least > 0.0 ? "%.0f" : "%.3g", value);
      const Settings smaller = join(m_extra, {{pointer, digits}});
      Place again = m_map.run_with(m_place, smaller);
      if (again.outcome != m_place.outcome) return;
      m_extra = smaller;
      m_place = std::move(again);
    }
  }

  const StabilityMap& m_map;
  Place m_place;
  Settings m_extra;
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
