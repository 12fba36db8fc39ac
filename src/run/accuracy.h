#pragma once

#include <vector>

#include "run/run.h"
#include "scenario/scenario.h"
#include "sim/record.h"

namespace argil::run {

/// Mean square difference of the force at the hand in two runs of a motion, over the ticks in which either
/// touches, as a root and a share of that of the second; against a mean below `floor` [N], of that.
double compare_forces(const std::vector<sim::HapticRecord>& a, const std::vector<sim::HapticRecord>& b,
                      double floor);

/// A run of a motion on some cells, and the error of its force. The error of ten-node tets under a tool falls
/// as the size of cells to the power 3/2, and from one mesh to another it is larger and smaller. So what a
/// run differs by from one on fewer cells is the other's error for the most part, and its own is so much
/// smaller.
struct AccuracyPass {
  double cells = 0.0;  ///< along the largest radius of contact
  int num_tets = 0;
  std::vector<sim::HapticRecord> haptic;
  double error = 0.0;  ///< of the force, over the force; not known of the first pass
};

/// The error of a pass after one on fewer cells.
double estimate_error(const AccuracyPass& coarse, const AccuracyPass& fine, double floor);

/// Cells along the radius of contact that a pass comes with: the first, those of experience for the wanted
/// error; later, those at which the last pass's error would be well below it.
double choose_cells(const std::vector<AccuracyPass>& passes, double wanted);

/// As run_loaded, of a scenario with /fidelity/accuracy. Ten-node tets are laid small where the tool comes,
/// and run on smaller ones until two runs say that the force is as exact as asked: three such passes at most,
/// then the run. The last of them is the result; notes in it say what was tried. A first pass that only helps
/// to know the error leaves nothing. With `resume` it goes on where the result ends, to the same bits.
RunEnd run_to_accuracy(const scenario::Scenario& s, const RunOptions& options);

}  // namespace argil::run
