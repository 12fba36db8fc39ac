#pragma once

#include <span>
#include <vector>

#include "material/moisture.h"
#include "sim/params.h"
#include "sim/state.h"

namespace argil::sim {

/// Moduli, yield, size and weight of every tet of the solid as its water makes them (eq. 6).
class BodyMaterials {
 public:
  /// All are kept by reference.
  BodyMaterials(const Body& body, const Params& params, const water::PoreWater& water, solid::Body& solid,
                solid::ActiveRegion& region);

  /// Brings every tet up to date.
  void set_all();
  /// Brings up to date the tets whose saturation moved by more than `tolerance` since they last were.
  /// Returns them, increasing.
  std::span<const int> refresh(double tolerance);

  bool is_isotropic() const { return m_moisture.is_isotropic(); }
  const Field& yield() const { return m_yield; }  ///< of each point: elastic strain norm [–]
  /// 2μ* [Pa] of the isotropic law nearest to a tet's.
  double shape_stiffness(int tet) const;

  void commit() { m_changed.clear(); }
  void roll_back();
  void serialize(Archive& archive);

 private:
  void set(int tet, double S);

  const Body& m_body;
  const Params& m_params;
  const water::PoreWater& m_water;
  solid::Body& m_solid;
  solid::ActiveRegion& m_region;
  material::MoistureTable m_moisture;
  Field m_saturation;  // S of each tet for which it was last brought up to date
  Field m_yield;
  std::vector<double> m_shape_stiffness;  // of each tet; empty: isotropic, or not needed
  std::vector<int> m_changed;             // since the last commit
  std::vector<double> m_before;           // S of these before
};

}  // namespace argil::sim
