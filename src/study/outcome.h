#pragma once

#include <string>

#include "study/cases.h"
#include "study/measure.h"

namespace argil::study {

/// What became of a run.
enum class Outcome {
  accurate,        ///< stable, and as near to the truth as was asked
  wrong,           ///< stable, but farther from it
  growing_energy,  ///< more mechanical energy than the hand gave it
  chatter,         ///< the force at the hand trembles above 50 Hz
  inverted,        ///< a tet turned inside out or collapsed
  not_converged,   ///< a solve found no solution
  failed,          ///< ended with code 3 for another reason
  refused,         ///< not accepted before the start
  killed,          ///< by a signal, or it could not write: says nothing of the method
  unknown,         ///< stable, but there was nothing to compare it with
};

/// Bounds between these.
struct OutcomeBounds {
  double wrong_above = 0.1;    ///< relative L² error of the hand force
  double growing_above = 0.1;  ///< RunFigures::energy_gain
  double chatter_above = 0.1;  ///< RunFigures::chatter: the just noticeable difference; and twice the truth's
  bool compares = false;       ///< there is to be a truth: without one, accuracy is unknown
};

/// `figures` and `errors` count for runs that reached their end; errors.force is no number where there was
/// nothing to compare with.
Outcome classify(const CaseResult& result, const RunFigures& figures, const RunErrors& errors,
                 const OutcomeBounds& bounds);

/// Did it stay in its bounds, right or wrong?
bool is_stable(Outcome outcome);
/// Does it say anything of the method?
bool is_known(Outcome outcome);

std::string to_string(Outcome outcome);

}  // namespace argil::study
