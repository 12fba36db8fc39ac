#pragma once

#include "solid/tet_lanes.h"

namespace argil::solid {

// Curnier's law at eight points at a time; at one: law_curnier.cpp.

/// fᵢ = V P ∇Nᵢ of points begin … end−1, at most kLanes of them.
void compute_curnier_forces(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Their elastic energy V (μ E:E + ½ λ θ²) [J].
double compute_curnier_energy(const ForceArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

/// Their stiffness.
void compute_curnier_stiffness(const TangentArrays& tets, std::ptrdiff_t begin, std::ptrdiff_t end);

}  // namespace argil::solid
