#pragma once

#include <span>
#include <vector>

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
  /// `triangle` are boundary faces of the topology, `area` [m²] what the tool touches of each. Fills up to S
  /// = 1, empties down to 0; what the tet cannot take stays with the tool. Every gram is booked.
  void exchange(std::span<const int> triangle, std::span<const double> area, int sign, double step_s);

  /// Diffuses for `step_s` by two-point fluxes in explicit substeps within the monotone limit; conservative
  /// to round-off. Only tets with water or a wet neighbour are touched. Returns the number of substeps.
  int diffuse(double step_s);

  /// Replaces `tets` by those whose saturation moved by more than `tolerance` since they were last collected,
  /// in increasing order; the first call collects all.
  void collect_changed(double tolerance, std::vector<int>& tets);

  const Field& saturation() const { return m_saturation; }
  double capacity(int tet) const { return m_capacity(tet); }  ///< mass at S = 1 [kg]
  double mass() const;                                        ///< Σ capacity·S [kg], compensated sum
  WaterLedger ledger() const;
  double ledger_error() const;  ///< (mass − initial − added + removed) / Σ capacity [–]
  double monotone_step() const {
    return m_monotone_step;
  }  ///< longest substep [s] that keeps the maximum principle
  int num_active() const {
    return static_cast<int>(m_active.size());
  }  ///< tets that are wet or next to a wet one

 private:
  /// Sum that carries its rounding error along [Neumaier 1974].
  struct CompensatedSum {
    double sum = 0.0;
    double error = 0.0;
    void add(double x);
    double value() const { return sum + error; }
  };

  void activate(int tet);
  void activate_around(int tet);
  void give(int tet, double mass);

  WaterParams m_params;
  Tets m_neighbours;
  std::vector<int> m_boundary_tet;
  Eigen::Matrix4Xd
      m_conductance;  // D·A_f/d_f across the face opposite to each corner [m³/s]; 0 at the boundary
  Field m_volume;     // rest volume [m³]
  Field m_capacity;
  Field m_saturation;
  Field m_flow;       // Σ of the flows into each active tet [m³/s of S]
  Field m_collected;  // saturation when collect_changed last named the tet
  std::vector<char> m_is_active;
  std::vector<int> m_active;
  std::vector<int> m_touched;
  bool m_all_pending = true;
  double m_monotone_step = 0.0;
  double m_initial = 0.0;
  CompensatedSum m_added, m_removed;
};

}  // namespace argil::water
