#pragma once

#include <vector>

#include "solid/law.h"

namespace argil::test {

inline std::vector<solid::StrainModel> every_model() {
  std::vector<solid::StrainModel> models;
  for (std::size_t i = 0; i < solid::kElasticLaws.size(); ++i)
    models.push_back(static_cast<solid::StrainModel>(i));
  return models;
}

/// Those to which Newton's method is more than one linear solve.
inline std::vector<solid::StrainModel> every_nonlinear_model() {
  std::vector<solid::StrainModel> models;
  for (const solid::StrainModel model : every_model())
    if (!find_law(model).is_linear) models.push_back(model);
  return models;
}

}  // namespace argil::test
