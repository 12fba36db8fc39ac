#pragma once

#include <string>
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
  double error = 0.0;  ///< of the force for its cells, over the force; not known of the first pass
};

/// Key of the number of tets that a body is made of; empty where a file has them.
std::string find_target_pointer(const scenario::BodySpec& body);

/// Numbers of ticks that a step can have when two of them are tried: divisors of the periods of frames and
/// water, increasing. Empty where a step must stay as it is given: that of an explicit integrator is bounded
/// by stability.
std::vector<int> find_step_lengths(const scenario::Scenario& s);

/// Two passes on the same cells with steps of two lengths. Held and implicit forces are off by
/// the first power of the step, for which they differ.
struct StepPasses {
  int short_ticks = 1, long_ticks = 1;
  AccuracyPass with_short, with_long;

  /// Error of the force for a step of one tick, over the force.
  double find_error_of_a_tick(double floor) const;
  /// The same cells with a step of another length, by the line through both forces.
  AccuracyPass at(int ticks) const;
};

/// The longest step that leaves most of the wanted error to the cells, no longer than the longer that was
/// tried; the shortest where none does.
int choose_step(const std::vector<int>& lengths, int longest, double error_of_a_tick, double wanted);

/// The error of a pass after one on fewer cells.
double estimate_error(const AccuracyPass& coarse, const AccuracyPass& fine, double floor);

/// Cells along the radius of contact that a pass comes with: the first, those of experience for the wanted
/// error; later, those at which the last pass's error would be well below it.
double choose_cells(const std::vector<AccuracyPass>& passes, double wanted);

/// As run_loaded, of a scenario with /fidelity/accuracy. Ten-node tets are laid small where the tool comes,
/// and run on smaller ones until two runs say that the force is as exact as asked: three such passes at most,
/// then the run. The first is made twice, with steps of two lengths, which says how long the others' may be.
/// The last run is the result; notes in it say what was tried. Passes that only help to know the error leave
/// nothing. With `resume` it goes on where the result ends, to the same bits.
RunEnd run_to_accuracy(const scenario::Scenario& s, const RunOptions& options);

}  // namespace argil::run
