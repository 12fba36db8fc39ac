#pragma once

#include <limits>
#include <string>

#include "output/result_reader.h"
#include "output/study_table.h"
#include "scenario/sweep_file.h"

namespace argil::study {

/// What a table says of a run; NaN: not known.
struct SweepFigures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double peak_force = kNone;        ///< [N] at the hand
  double mean_force = kNone;        ///< [N] over the ticks in touch
  double impulse = kNone;           ///< [N s] of the force's magnitude over the motion
  double work = kNone;              ///< [J] of the contact forces on the body
  double dissipation = kNone;       ///< [J] by plastic flow
  double indentation = kNone;       ///< [m] largest displacement of a vertex from rest, over the frames
  double final_saturation = kNone;  ///< [–] mean of the last frame by volume
  double final_water = kNone;       ///< [kg] in the body at the end
  double water_added = kNone;       ///< [kg]
  double water_removed = kNone;     ///< [kg]
  double water_error = kNone;       ///< [kg] change of the water in the body less what was added and taken
  double steps = kNone;
  double iterations = kNone;  ///< of the linear solver
  double factorisations = kNone;
};

SweepFigures compute_sweep_figures(const output::ResultReader& result);

/// Rows of a sweep's table.
class SweepTable {
 public:
  void add(const scenario::SweepPoint& point, const std::string& outcome, const std::string& reason,
           const SweepFigures& figures);
  output::StudyTable take();

 private:
  struct Row {
    scenario::SweepPoint point;
    std::string outcome;
    std::string reason;
    SweepFigures figures;
  };
  std::vector<Row> m_rows;
};

}  // namespace argil::study
