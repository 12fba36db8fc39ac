#pragma once

#include <CLI/CLI.hpp>

#include <cmath>
#include <string>

namespace argil::cli {

/// Checks that a number is finite and above 0, or from 0; CLI11's own checks let NaN and infinity pass.
inline CLI::Validator finite_number(bool may_be_zero) {
  const auto check = [may_be_zero](const std::string& text) {
    double value = 0.0;
    const bool is_number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    if (is_number && (value > 0.0 || (may_be_zero && value == 0.0))) return std::string();
    return text + " is not a finite number " + (may_be_zero ? "from 0" : "above 0");
  };
  return CLI::Validator(check, "NUMBER");
}

}  // namespace argil::cli
