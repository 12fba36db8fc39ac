#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solid/law.h"

namespace argil::scenario {

/// The elastic laws with their names in JSON.
std::vector<std::pair<solid::StrainModel, std::string>> strain_model_names();

/// One sentence that names each law and what it is for.
std::string describe_strain_models();

/// The law of a JSON name, or null.
const solid::ElasticLaw* find_law_by_name(const std::string& name);

}  // namespace argil::scenario
