#include "study/figures_beside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "base/error.h"
#include "output/result_reader.h"
#include "output/text.h"
#include "study/sweep_figures.h"

namespace argil::study {
namespace {

struct Asked {
  const char* name;
  const char* unit;
  double SweepFigures::*figure;
  double in_unit;  // of SI: grams for kilograms, as prefixes want it
};

constexpr std::array<Asked, 6> kAsked = {{{"peak force", "N", &SweepFigures::peak_force, 1.0},
                                          {"impulse", "N s", &SweepFigures::impulse, 1.0},
                                          {"work on the body", "J", &SweepFigures::work, 1.0},
                                          {"water at the end", "g", &SweepFigures::final_water, 1e3},
                                          {"water given", "g", &SweepFigures::water_added, 1e3},
                                          {"largest displacement", "m", &SweepFigures::indentation, 1.0}}};

/// Damaged files and such that hold only a part of a run have none; the comparison itself says what they
/// lack.
std::optional<SweepFigures> find_figures(const std::string& file) {
  try {
    return compute_sweep_figures(output::ResultReader(file));
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const IoError&) {
    return std::nullopt;
  }
}

/// To so many signs, of which µ takes two bytes.
std::string padded(const std::string& text, std::size_t width) {
  const auto signs = static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  return text + std::string(signs < width ? width - signs : 1, ' ');
}

std::string print_difference(double a, double b, const char* unit) {
  if (a == b) return "0";
  char share[32] = "";
  if (a != 0.0) std::snprintf(share, sizeof share, " (%+.3g %%)", 100.0 * (b - a) / std::abs(a));
  return (b > a ? "+" : "") + output::with_prefix(b - a, unit) + share;
}

}  // namespace

std::string print_figures_beside(const std::string& file_a, const std::string& file_b) {
  const std::optional<SweepFigures> a = find_figures(file_a);
  const std::optional<SweepFigures> b = find_figures(file_b);
  if (!a || !b) return "";
  std::string text;
  const auto add = [&text](const std::string& name, const std::string& of_a, const std::string& of_b,
                           const std::string& difference) {
    text += padded(name, 22) + padded(of_a, 14) + padded(of_b, 14) + difference + "\n";
  };
  for (const Asked& asked : kAsked) {
    const double of_a = asked.in_unit * (*a).*asked.figure;
    const double of_b = asked.in_unit * (*b).*asked.figure;
    if (!std::isfinite(of_a) || !std::isfinite(of_b)) continue;  // an equilibrium has no hand
    if (text.empty()) add("", "a", "b", "b - a");
    add(asked.name, output::with_prefix(of_a, asked.unit), output::with_prefix(of_b, asked.unit),
        print_difference(of_a, of_b, asked.unit));
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace argil::study
