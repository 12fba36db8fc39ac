#pragma once

#include <span>

#include "mesh/topology.h"
#include "water/parameters.h"

namespace argil::water {

/// Kilograms in and out since the start.
struct WaterLedger {
  double initial = 0.0;  ///< [kg] in the body at the start
  double added = 0.0;    ///< [kg] given by the tool
  double removed = 0.0;  ///< [kg] taken by the tool
};

/// Water in the pores of every tet. Saturation S in [0, 1]; mass of a tet = ρ_w n V_rest S.
class PoreWater {
 public:
  /// `initial_saturation`: one value per tet. Throws nothing; ranges were checked with the scenario.
  PoreWater(const mesh::TetMesh& mesh, const mesh::Topology& topology, const WaterParams& params,
            const Field& initial_saturation);

  /// Takes up (sign > 0) or gives off (sign < 0) water through touched boundary triangles during `step_s`:
  /// `triangle` are boundary faces of the topology, `area` [m²] what the tool touches of each. Fills up to S = 1,
  /// empties down to 0; what the tet cannot take stays with the tool. Every gram is booked.
  void exchange(std::span<const int> triangle, std::span<const double> area, int sign, double step_s);

  /// Diffuses for `step_s` by two-point fluxes in explicit substeps within the monotone limit; conservative to
  /// round-off. Only tets with water or a wet neighbour are touched. Returns the number of substeps.
  int diffuse(double step_s);

  const Field& saturation() const { return m_saturation; }
  double mass() const;                  ///< Σ ρ_w n V S [kg], compensated sum
  const WaterLedger& ledger() const { return m_ledger; }
  double ledger_error() const;          ///< (mass − initial − added + removed) / capacity [–]
  double monotone_step() const;         ///< largest substep [s] that keeps the maximum principle

 private:
  WaterParams m_params;
  Field m_saturation;
  WaterLedger m_ledger;
};

}  // namespace argil::water
