#pragma once

#include <string>

#include "output/compare.h"

namespace argil::scenario {

/// Tolerances of a comparison: {"ignore": [PATH, …], "tolerances": [{"dataset": PATH, "relative": 1e-6,
/// "absolute": 1e-9, "of_largest": 1e-6}, …]}, * in a PATH standing for any text. What they mean:
/// CompareOptions. Every PATH must fit something in a compared file. Throws InputError naming file, pointer,
/// value and remedy, IoError.
output::CompareOptions load_tolerances(const std::string& file);

/// JSON Schema (2020-12) of such a file.
std::string print_tolerance_schema();

}  // namespace argil::scenario
