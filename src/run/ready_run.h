#pragma once

#include <memory>
#include <optional>
#include <string>

#include "output/result_file.h"
#include "run/full_model.h"
#include "run/hand_motion.h"
#include "run/identity.h"
#include "scenario/build.h"
#include "sim/simulation.h"

namespace argil::run {

/// A run that stands before its first tick: what `argil run` feeds to its loop, and what a program steps.
struct ReadyRun {
  /// Builds the scene. `given_trace` stands in for the scenario's in messages where it is not empty; `note`,
  /// if there is one, is said with the scene's. `start`: where the hand is; nothing: where the motion begins.
  /// Throws InputError, also where the tool starts in the body.
  ReadyRun(const scenario::Scenario& s, const std::string& given_trace, const std::string& note = "",
           const std::optional<device::DeviceSample>& start = std::nullopt);
  ReadyRun(const ReadyRun&) = delete;
  ReadyRun& operator=(const ReadyRun&) = delete;

  /// Of its result.
  output::ResultHeader make_header(const Identity& identity) const;

  const scenario::Scenario s;
  scenario::Scene scene;  ///< its body is the simulation's
  std::string miss;       ///< describe_miss
  const mesh::TriangleMesh tool;
  std::unique_ptr<FullModel> full;  ///< with `check`
  sim::Simulation simulation;
  HandMotion hand;
};

}  // namespace argil::run
