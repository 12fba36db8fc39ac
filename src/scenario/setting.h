#pragma once

#include <optional>
#include <string>

#include "scenario/json_document.h"
#include "scenario/scenario.h"

namespace argil::scenario {

/// Why a setting cannot be put into a document, and what to do.
struct Obstacle {
  std::string problem;
  std::string remedy;
};

/// Puts a setting into a scenario's document: what is not there yet is made, but for lists, of which one
/// element says too little. Nothing on success. Throws InputError for a value that is broken JSON.
[[nodiscard]] std::optional<Obstacle> apply_setting(Json& document, const Setting& setting);

/// The same of the scenario `file`. Throws InputError.
void apply_setting(Json& document, const Setting& setting, const std::string& file);

}  // namespace argil::scenario
