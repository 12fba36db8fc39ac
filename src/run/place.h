#pragma once

#include <optional>
#include <string>

#include "base/types.h"
#include "run/run.h"

namespace argil::run {

/// Where `argil place` brings a motion.
struct PlaceOptions {
  RunOptions run;            ///< what it reads of a run
  std::optional<Vec3> at;    ///< place that the tool is to touch [m]; none: where it is nearest
  std::optional<Vec3> from;  ///< with `at`: the direction that the tool comes from
  double depth = 0.0;        ///< of the tool in the body at rest [m]; 0: a quarter of the tool's radius
  std::string output;        ///< file of the patch; empty: standard output
};

/// Says where body and motion are, how near the tool comes and when, and writes a patch of the scenario with
/// the translation that lets the tool touch the body so deep. Rotation and scale stay as they are. Without a
/// place the motion goes along the line between body and tool where they are nearest, until it is nowhere
/// deeper than that. With one, the pose that goes farthest that way comes from the given side until it is so
/// deep there. As cells are graded by the motion, the body is built anew until both agree. Throws InputError
/// where that finds no touch or where the motion would start in the body.
int place(const PlaceOptions& options);

}  // namespace argil::run
