#pragma once

#include <string>

#include "output/result_reader.h"

namespace argil::output {

/// A page about a result file for a person: how the run ended, body, motion, peak force, water, deformation,
/// timing and what it was made from; a line each, its name in the first twelve columns. Throws as
/// ResultReader does.
std::string describe_result(const ResultReader& reader);

/// What ended a run, its likely cause, and what helps.
std::string describe_failure(const Failure& failure);

/// One line about steps whose motion was limited or that could not be made, and ticks in which the hand was
/// let go; empty without any.
std::string describe_limits(const std::vector<sim::PhysicsRecord>& steps,
                            const std::vector<sim::HapticRecord>& ticks, int num_tets);

}  // namespace argil::output
