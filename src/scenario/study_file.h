#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace argil::scenario {

/// What a chart's table calls the runs of its reference; no curve may have these names.
inline constexpr const char* kReferenceName = "reference";
inline constexpr const char* kRefinedName = "reference refined";

/// Runs that differ in a few settings, one curve of a chart.
struct Curve {
  std::string name;                          ///< not empty, and of this curve alone
  std::vector<Setting> settings;             ///< of all its points; none that `points` set
  std::vector<std::vector<Setting>> points;  ///< what each point adds, in the file's order
};

/// What `argil chart` compares: a scene, the run that counts as the truth, one that is finer still, and
/// curves.
struct ChartStudy {
  std::string file;
  std::string about;
  std::string scenario;            ///< file of the scene, relative to the study's folder in the JSON
  std::vector<Setting> settings;   ///< of every run
  std::vector<Setting> reference;  ///< of the reference
  std::vector<Setting> refined;    ///< of a reference with one more refinement, on top of `reference`
  std::vector<Curve> curves;
  int repeats = 3;  ///< runs of each point, whose median cost counts
};

/// One direction of a stability map.
struct MapAxis {
  std::string name;                   ///< as drawn, with its unit
  std::vector<std::string> pointers;  ///< keys that take the value; none of the other axis
  bool is_logarithmic = false;
  bool is_integer = false;
  std::vector<double> values;  ///< increasing
};

/// A limit that theory gives, drawn over the map.
struct MapLimit {
  std::string name;
  std::vector<double> x;  ///< points of a line
  std::vector<double> y;  ///< the same number; empty for a map of one axis
};

/// What `argil stability` maps: a scene over one or two axes.
struct StabilityStudy {
  std::string file;
  std::string about;
  std::string scenario;
  std::vector<Setting> settings;
  MapAxis x;
  MapAxis y;                       ///< without values: a line
  std::vector<Setting> reference;  ///< makes of each point a run that counts as the truth, also in what an
                                   ///< axis sets; empty: none
  double wrong_above = 0.1;        ///< relative L² error of the hand force beyond which a run is wrong [–]
  double bisect_to = 0.02;         ///< relative width to which boundaries along x are found; 0: not at all
  std::vector<MapLimit> limits;
  std::vector<std::string> notes;  ///< what the user should know of it
};

/// Read and check a study file. Throw InputError naming file, pointer, value and remedy, IoError. Settings
/// must have a place in the scene; their values are checked when it is loaded with them.
ChartStudy read_chart_study(const std::string& file);
StabilityStudy read_stability_study(const std::string& file);

}  // namespace argil::scenario
