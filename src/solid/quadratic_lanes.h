#pragma once

#include <cstddef>

namespace argil::solid {

// From the points of 10-node tets to their nodes. At each point ∇Nᵢ = Σ (∂Nᵢ/∂λ_a) ∇λ_a, so forces and
// stiffness of the nodes are sums of those of the points' four corners. Of tets begin … end−1.

/// fᵢ = Σ (∂Nᵢ/∂λ_a) f_a. of_points: f_a, 12 a point; of_nodes: 30 a tet.
void set_node_forces(const double* of_points, std::ptrdiff_t begin, std::ptrdiff_t end, double* of_nodes);

/// Kᵢⱼ = Σ (∂Nᵢ/∂λ_a) K_ab (∂Nⱼ/∂λ_b). of_points: kPairBlocks 3×3 a point; of_nodes: kQuadraticPairs a tet.
void set_node_pairs(const double* of_points, std::ptrdiff_t begin, std::ptrdiff_t end, double* of_nodes);

}  // namespace argil::solid
