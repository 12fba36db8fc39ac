#pragma once

#include <string>

#include "run/placing.h"
#include "run/run.h"

namespace argil::run {

/// Where `argil place` brings a motion.
struct PlaceOptions {
  RunOptions run;  ///< what it reads of a run
  Touch touch;
  std::string output;  ///< file of the patch; empty: standard output
};

/// Says where body and motion are, how near the tool comes and when, and writes a patch of the scenario with
/// the translation that lets the tool touch the body so deep. Rotation and scale stay as they are. Without a
/// place the motion goes along the line between body and tool where they are nearest, until it is nowhere
/// deeper than that. With one, the pose that goes farthest that way comes from the given side until it is so
/// deep there. As cells are graded by the motion, the body is built anew until both agree. Throws InputError
/// where that finds no touch or where the motion would start in the body.
int place(const PlaceOptions& options);

}  // namespace argil::run
