#pragma once

// Bodies with known answers, each solved at any refinement: what the tests check at a coarse one and what
// scripts/make_verification.py draws.

#include <vector>

#include "solid/parameters.h"

namespace argil::verification {

/// Tip deflection of a clamped bar (1 × 0.2 × 0.2 m, E = 1 MPa, ν) under 1 N of end shear [m]; n cells
/// across.
double solve_cantilever(solid::ElementKind element, double nu, int n,
                        solid::StrainModel model = solid::StrainModel::linear);

/// The same of a Timoshenko beam with the shear factor 5/6 [Timoshenko1921]: F L³/(3EI) + F L/(5/6 G A).
double compute_timoshenko_deflection(double nu);

/// Torsion constant J/a⁴ of a square bar whose ends turn about its axis and may warp: T = G J θ/L.
double solve_torsion(solid::ElementKind element, int n);
inline constexpr double kSquareTorsion = 0.1405770;  ///< Saint-Venant: ⅓ (1 − 192/π⁵ Σ tanh(nπ/2)/n⁵), n odd

/// Displacement along a unit force at the tip of a twisted beam [MacNeal1985]: 12 long, 1.1 wide, 0.32 thick,
/// turned by 90° from root to tip, E = 29e6, ν = 0.22, clamped at the root; the force, spread over the end,
/// acts along the tip's width or along its thickness; n cells across the thickness, 2n across the width.
enum class TipForce { along_width, along_thickness };
double solve_twisted_beam(solid::ElementKind element, TipForce force, int n);
inline constexpr double kTwistedAlongWidth = 5.424e-3;      ///< beam theory [MacNeal1985]
inline constexpr double kTwistedAlongThickness = 1.754e-3;  ///< likewise

/// Vertical displacement of the right edge's middle in Cook's membrane [Cook1974]: corners (0,0), (48,44),
/// (48,60), (0,44), thickness 1, unit shear force on the right edge, E = 1. Plane stress by free faces, or
/// plane strain by held ones; n cells an edge.
double solve_cook(solid::ElementKind element, double nu, bool is_plane_strain, int n);
inline constexpr double kCookPlaneStress = 23.96;  ///< ν = 1/3: fine meshes of others; 23.9 in [Bergan1985]

/// Errors of the manufactured solution u = a sin πx sin πy sin πz on an irregular mesh of the unit cube with
/// n cells an edge, relative; μ = 1.
struct FieldErrors {
  double l2 = 0.0;
  double h1 = 0.0;  ///< of the gradient
};
FieldErrors solve_manufactured(solid::ElementKind element, double nu, int n);

/// Lowest natural frequencies above the six rigid ones of a free cube [rad/s]; n cells an edge.
std::vector<double> find_frequencies(solid::ElementKind element, double nu, int n, int count);

/// What a free bar (E = 30 kPa by default) has lost after one turn: relative changes. NaN when a step failed
/// or the body flew apart.
struct SpinDrift {
  double energy = 0.0;
  double momentum = 0.0;  ///< angular, norm of the change
};
SpinDrift solve_spin(solid::Integrator integrator, solid::Iteration iteration, int steps,
                     double youngs_modulus = 3e4);

/// The same of a rigid body with the bar's masses in backward Euler: each step goes to the turn of the rest
/// shape that is nearest to x + h v in the norm of the masses, found by singular value decomposition.
SpinDrift compute_rigid_spin(int steps);

/// Position and velocity error of a thrown, strongly bent bar against a fine reference, relative.
double solve_swing(solid::Integrator integrator, int steps);

}  // namespace argil::verification
