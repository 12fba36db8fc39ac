#pragma once

#include "solid/tet_lanes.h"

namespace argil::solid {

// Hencky's law of 4-node tets, eight at a time; at one point: law_hencky.cpp.

/// fᵢ = V P ∇Nᵢ, P = τ F⁻ᵀ, of tets begin … end−1, at most kLanes of them.
void compute_hencky_forces(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Their elastic energy V (μ ε:ε + ½ λ (tr ε)²) [J].
double compute_hencky_energy(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Points that may flow, and how.
struct FlowArrays {
  const double* strain = nullptr;    ///< S − 1, Mandel, 6 a point
  double* plastic_strain = nullptr;  ///< E_p, 6 a point
  const double* yield = nullptr;     ///< ‖dev ε‖ at which a point flows, 1 a point
  double most = 1.0;                 ///< largest share of the deviator that flows
  bool stops_at_yield = true;        ///< no more flows than what is beyond the yield
  ElasticArrays elastic = {};        ///< before the flow
};

/// Radial return of points begin … end−1, at most kLanes of them, at held F; bit p − begin is set where p
/// flowed. released: ‖dev ε‖² that each loses.
unsigned flow_by_hencky(const FlowArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end, double* released);

/// Stiffness of tets, from the deformation F that each had when it was last made.
struct TangentArrays {
  const double* gradient = nullptr;        ///< 12 a tet
  const double* F = nullptr;               ///< 9 a tet
  const double* plastic_strain = nullptr;  ///< 6 a tet
  const double* weight = nullptr;          ///< volume
  const double* lambda = nullptr;          ///< 1 a tet [Pa]
  const double* mu = nullptr;              ///< 1 a tet [Pa]
  double exact = 1.0;                      ///< how often ∂²W/∂x² enters, its negative modes left out
  double kept = 0.0;                       ///< and the stiffness of the shape at rest, turned by R
  double* blocks = nullptr;                ///< kPairBlocks 3×3 a tet, of the pairs of its corners
};

void compute_hencky_stiffness(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

}  // namespace argil::solid
