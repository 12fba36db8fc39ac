#pragma once

#include <string>

namespace argil::study {

/// What a person asks of two results, a line each: the figure of the one, of the other, and their difference.
/// Empty where one of them lacks what the figures are made of. Throws IoError.
std::string print_figures_beside(const std::string& file_a, const std::string& file_b);

}  // namespace argil::study
