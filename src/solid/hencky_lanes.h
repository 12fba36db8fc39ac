#pragma once

#include "material/plasticity.h"
#include "solid/tet_lanes.h"

namespace argil::solid {

// Hencky's law at eight points at a time; at one: law_hencky.cpp.

/// fᵢ = V P ∇Nᵢ, P = τ F⁻ᵀ, of points begin … end−1, at most kLanes of them.
void compute_hencky_forces(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Their elastic energy V (μ ε:ε + ½ λ (tr ε)²) [J].
double compute_hencky_energy(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Elastic strain ½ ln b of points begin … end−1, at most kLanes of them, in the frame of R: 6 a point, 11 22
/// 33 23 13 12 as in the matrix. strain: S − 1; plastic_strain: E_p; both Mandel.
void find_hencky_strain(const double* strain, const double* plastic_strain, std::ptrdiff_t begin,
                        std::ptrdiff_t end, double* elastic);

/// Points that may flow, and how.
struct FlowArrays {
  const double* strain = nullptr;    ///< S − 1, Mandel, 6 a point
  double* plastic_strain = nullptr;  ///< E_p, 6 a point
  const double* yield = nullptr;     ///< ‖dev ε‖ at which a point flows, 1 a point
  material::FlowRule rule = {};      ///< how much of the deviator flows
  ElasticArrays elastic = {};        ///< before the flow
  bool is_balanced_after = true;     ///< the stress after the flow is what balanced the step's forces
};

/// Radial return of points begin … end−1, at most kLanes of them, at held F; bit p − begin is set where p
/// flowed. dissipated: what each loses, over μ and its volume: 2 dev ε_e : Δε_p of the stress that balanced
/// the step's forces, so that the work put in is stored or lost. That is the stress after the flow (backward
/// Euler's σ : Δε_p); where forces were balanced at held plastic strain, it is what flow releases, ‖dev ε_e‖²
/// before less after. No point flows to ‖E_p‖ > 8.
unsigned flow_by_hencky(const FlowArrays& points, std::ptrdiff_t begin, std::ptrdiff_t end,
                        double* dissipated);

/// Share of the yield from which a point's stiffness is that of one that flows.
inline constexpr double kAtYield = 1.0 - 1e-6;

/// Their stiffness.
void compute_hencky_stiffness(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

}  // namespace argil::solid
