#pragma once

#include <string>

namespace argil::output {

/// A page about a result file for a person: how the run ended, body, ticks, peak force, water, deformation,
/// timing. Throws as ResultReader does.
std::string describe_result(const std::string& file);

}  // namespace argil::output
