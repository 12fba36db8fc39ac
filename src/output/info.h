#pragma once

#include <string>

#include "output/result_reader.h"

namespace argil::output {

/// A page about a result file for a person: how the run ended, body, motion, peak force, water, deformation,
/// timing and what it was made from; a line each, its name in the first twelve columns. Throws as
/// ResultReader does.
std::string describe_result(const ResultReader& reader);

}  // namespace argil::output
