#include "scenario/strain_models.h"

#include <cstddef>

namespace argil::scenario {

std::vector<std::pair<solid::StrainModel, std::string>> strain_model_names() {
  std::vector<std::pair<solid::StrainModel, std::string>> names;
  for (std::size_t i = 0; i < solid::kElasticLaws.size(); ++i)
    names.emplace_back(static_cast<solid::StrainModel>(i), solid::kElasticLaws[i]->name);
  return names;
}

std::string describe_strain_models() {
  std::string text = "Elastic law: ";
  for (const solid::ElasticLaw* law : solid::kElasticLaws)
    text += std::string(law == solid::kElasticLaws.front() ? "" : ", ") + law->name + " (" + law->about + ')';
  return text + '.';
}

const solid::ElasticLaw* find_law_by_name(const std::string& name) {
  for (const solid::ElasticLaw* law : solid::kElasticLaws)
    if (name == law->name) return law;
  return nullptr;
}

}  // namespace argil::scenario
