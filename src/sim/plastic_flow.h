#pragma once

#include <cstddef>
#include <vector>

#include "sim/body_materials.h"

namespace argil::sim {

/// Plastic flow of every point of the solid over a step.
class PlasticFlow {
 public:
  /// All are kept by reference.
  PlasticFlow(const Params& params, const BodyMaterials& materials, solid::Solid& solid);

  /// Flow of every point that moves and whose elastic strain lies beyond its yield, at the present
  /// kinematics. Returns what it dissipates [J].
  double apply(TensorField& plastic_strain);

  bool is_anywhere() const { return m_is_anywhere; }  ///< in the last step
  /// Of each run of kLanes points, in the last step.
  const std::vector<char>& is_flowing() const { return m_is_flowing; }
  void serialize(Archive& archive) { archive.number("fidelity/flows", m_is_anywhere); }

 private:
  double apply_to_points(std::ptrdiff_t begin, std::ptrdiff_t end, TensorField& plastic_strain);
  double apply_to_point(int point, TensorField& plastic_strain) const;
  Vec6 compute_flow(int point, const Vec6& before) const;

  const Params& m_params;
  const BodyMaterials& m_materials;
  solid::Solid& m_solid;
  bool m_has_additive_split;
  bool m_is_driven;  // by the stress, not the strain
  bool m_is_anywhere = false;
  std::vector<char> m_is_flowing;
};

}  // namespace argil::sim
