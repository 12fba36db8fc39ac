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

  /// Brings every tet up to date. Called once, by the owner, when the solid is ready for it.
  void set_all();
  /// Brings up to date the tets whose saturation moved by more than `tolerance` since they last were.
  /// Returns them, increasing.
  std::span<const int> refresh(double tolerance);

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
  Field m_saturation_used;  // of each tet [–]: the one that its moduli were made for
  bool m_needs_shape_stiffness;
  std::vector<int> m_changed;         // since the last commit
  std::vector<double> m_used_before;  // saturation used by these before
};

}  // namespace argil::sim
