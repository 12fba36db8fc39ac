#pragma once

#include <cstddef>
#include <vector>

#include "material/plasticity.h"
#include "sim/params.h"
#include "sim/state.h"

namespace argil::sim {

/// Plastic flow of every point of the solid over a step.
class PlasticFlow {
 public:
  /// All are kept by reference.
  PlasticFlow(const Params& params, const solid::Body& solid, const solid::ActiveRegion& region);

  /// Flow of every point that moves and whose elastic strain lies beyond its yield, at the present
  /// kinematics. Returns what it dissipates [J].
  double apply(TensorField& plastic_strain);

  bool is_anywhere() const { return m_is_anywhere; }  ///< in the last step
  /// Of each run of kLanes tets, in the last step.
  const std::vector<char>& is_flowing() const { return m_is_flowing; }
  /// Likewise, in the step before.
  const std::vector<char>& was_flowing() const { return m_was_flowing; }
  void commit();
  void roll_back();
  void serialize(Archive& archive);

 private:
  bool is_flowing_anywhere() const;
  bool is_driven() const;
  double flow_by_law(std::ptrdiff_t begin, std::ptrdiff_t end, TensorField& plastic_strain,
                     bool& is_flowing) const;
  double apply_to_points(std::ptrdiff_t begin, std::ptrdiff_t end, TensorField& plastic_strain,
                         bool& is_flowing) const;
  double apply_to_point(int point, TensorField& plastic_strain) const;
  Vec6 compute_flow(int point, const Vec6& before) const;

  const Params& m_params;
  const solid::Body& m_solid;
  const solid::ActiveRegion& m_region;
  solid::PlasticSplit m_split;
  material::FlowRule m_rule;
  bool m_is_anywhere = false, m_was_anywhere = false;
  std::vector<char> m_is_flowing, m_was_flowing;
};

}  // namespace argil::sim
