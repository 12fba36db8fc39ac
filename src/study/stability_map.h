#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "scenario/study_file.h"
#include "study/cases.h"
#include "study/measure.h"
#include "study/outcome.h"
#include "study/study_output.h"

namespace argil::study {

/// A place on a stability map and what happened there.
struct Place {
  double x = 0.0;
  double y = kUnknown;
  CaseResult result;
  CaseResult truth;
  Outcome outcome = Outcome::killed;
  RunFigures figures;
  double true_peak_force = kUnknown;  ///< [N]
  RunErrors errors;
};

/// What is changed of every run of a study.
struct Variation {
  Settings added;                    ///< on top of axes and settings, below the reference
  std::vector<std::string> dropped;  ///< pointers of the study's settings that are left out
};

/// Two neighbouring places of one row of the map between which the outcome turns.
struct Boundary {
  std::size_t below;  ///< in the list of places
  std::size_t above;
};

/// The runs of a stability study: its grid, then bisection along x.
class StabilityMap {
 public:
  /// Both are kept by reference.
  StabilityMap(const scenario::StabilityStudy& study, const CaseOptions& options)
      : m_study(study), m_options(options) {}

  void run();
  const std::vector<Place>& places() const { return m_places; }
  const std::vector<Boundary>& boundaries() const { return m_boundaries; }
  const scenario::StabilityStudy& study() const { return m_study; }
  Settings settings_at(double x, double y, const Variation& variation = {}) const;
  scenario::Scenario load_place(const Place& place, const Variation& variation) const;
  /// A place anew, varied; not in the list. Without `has_truth` it is not compared with the reference.
  Place run_with(const Place& place, const Variation& variation, bool has_truth) const;

 private:
  std::vector<Place> run_places(const std::vector<std::pair<double, double>>& points,
                                const Variation& variation, bool has_truth) const;
  std::vector<std::size_t> visit(const std::vector<std::pair<double, double>>& points);
  void judge(Place& place, const Variation& variation, bool has_truth) const;
  bool turns(std::size_t a, std::size_t b) const;
  std::optional<double> find_middle(const Boundary& boundary) const;
  bool bisect();

  const scenario::StabilityStudy& m_study;
  const CaseOptions& m_options;
  std::vector<Place> m_places;
  std::vector<Boundary> m_boundaries;
};

}  // namespace argil::study
